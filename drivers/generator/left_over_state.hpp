// What another program or a person may have left in a generator, beside frequency and voltage, that
// changes what leaves its output: how it is reset and read back, by family.
//
//   family   *IDN? names                       what is reset and read back
//   rigol    Rigol DG800 to DG5000, and the    burst, sweep, modulation (one state of all kinds),
//            virtual bench as it usually is    DC offset, start phase, polarity
//   keysight 33500, 33600 (Agilent, Keysight)  the same, with a state for each kind of modulation
//   unknown  anything else                     all of them; what it refuses it does not have, and
//                                              an answer that does not come is not asked for again
//
// An answer of "ON" or "1", of "INVerted", or of a number that is not 0 contradicts a reset; one
// that says neither is no answer. Offset in V, phase in the instrument's unit. Another family is
// a row of `families` in left_over_state.cpp. Pure functions; any thread.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace dyncal::drivers::generator {

struct LeftOverState {
  const char* name;  // for people
  const char* reset; // the command
  const char* query;
};

struct GeneratorFamily { // a row
  const char* name;
  // An instrument is of the family where the answer to *IDN?, in capitals, has all words of one of
  // these lists in it.
  std::vector<std::vector<std::string_view>> identities;
  std::vector<LeftOverState> states;
  bool is_known = true;
};

[[nodiscard]] std::span<const GeneratorFamily> generator_families();

// The first row that the answer to *IDN? fits; where none does, one of all states that is not
// known.
[[nodiscard]] const GeneratorFamily&
family_of(std::string_view identity, std::span<const GeneratorFamily> rows = generator_families());

// One of all families' states, which is asked before the output is switched on each time.
constexpr const char* offset_query = ":SOURce1:VOLTage:OFFSet?";

// Of a setting that was reset to 0 and is rounded to the instrument's resolution, in V or degrees.
constexpr double reset_rounding = 1e-3;

// Whether the answer to such a query says that nothing is left; nothing where it says neither.
[[nodiscard]] std::optional<bool> says_reset(std::string_view answer);

} // namespace dyncal::drivers::generator
