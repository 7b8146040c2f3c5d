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
// another row of the table in left_over_state.cpp. Pure functions; any thread.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace dyncal::drivers::generator {

enum class GeneratorFamily { unknown, rigol, keysight };

// `identity`: the answer to *IDN?.
[[nodiscard]] GeneratorFamily family_of(std::string_view identity);

struct LeftOverState {
  const char* name;  // for people
  const char* reset; // the command
  const char* query;
};

[[nodiscard]] std::span<const LeftOverState> left_over_states(GeneratorFamily family);

// One of all families' states, which is asked before the output is switched on each time.
constexpr const char* offset_query = ":SOURce1:VOLTage:OFFSet?";

// Of a setting that was reset to 0 and is rounded to the instrument's resolution, in V or degrees.
constexpr double reset_rounding = 1e-3;

// Whether the answer to such a query says that nothing is left; nothing where it says neither.
[[nodiscard]] std::optional<bool> says_reset(std::string_view answer);

} // namespace dyncal::drivers::generator
