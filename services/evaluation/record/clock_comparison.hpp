// Whether two steps, each found in two records, are the same two excitations: two clocks differ by
// an offset and a rate over the whole run, nothing else.
//
//   t_b = offset + (1 + r) t_a,     r = f_a / f_b - 1
//
// f is the frequency that sync has in either clock. Begin and end of an excitation are known to
// about one frame of their search, an end that was cut off not at all: the offsets of two pairs
// agree when one end of either does. At one frequency, phases tell more: an instant at which sync
// passes zero is one in both clocks, so that the times between them agree to a whole number of
// periods; of several frequencies, few offsets fit all. Phases tell nothing where the rate is known
// too badly for the time between.
//
// Plain functions, any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "services/evaluation/record/recorded_excitations.hpp"

namespace dyncal::inline evaluation {

struct ExcitationInBoth {
  const FoundExcitation* first = nullptr;
  const FoundExcitation* second = nullptr;
};

struct ClockRate { // of the second clock against the first
  double rel = 0.0;
  double u_rel = 0.0;
};

// Clocks and generators of instruments are right to a thousandth.
constexpr double max_clock_rate_rel = 1e-3;

// From the frequencies of all pairs. REQUIRES: at least one.
[[nodiscard]] ClockRate clock_rate(std::span<const ExcitationInBoth> pairs);

[[nodiscard]] bool have_same_frequency(const FoundExcitation& a, const FoundExcitation& b);

[[nodiscard]] bool instants_agree(const ExcitationInBoth& one, const ExcitationInBoth& other,
                                  const ClockRate& rate);
// Of a pair of which neither end is whole in both records, as where one has a hole and the other
// one ends within the step: what is left of it in both may be of one excitation of up to
// `longest_s`. False where an end of `other` is whole in both, or none of `one`.
[[nodiscard]] bool rests_agree(const ExcitationInBoth& one, const ExcitationInBoth& other,
                               const ClockRate& rate, double longest_s);
// How much later the other one begins in the second clock than it should.
[[nodiscard]] double lateness_s(const ExcitationInBoth& one, const ExcitationInBoth& other,
                                const ClockRate& rate);
// Nothing where they tell nothing.
[[nodiscard]] std::optional<bool>
phases_agree(const ExcitationInBoth& one, const ExcitationInBoth& other, const ClockRate& rate);
// Of pairs of several frequencies, of which one offset must turn all phases into each other; sync
// may be inverted in one of the records. Nothing where any offset might by chance.
[[nodiscard]] std::optional<bool> phases_have_one_offset(std::span<const ExcitationInBoth> pairs,
                                                         const ClockRate& rate);
// They are one excitation, where the clocks are `offset_ns` apart (second behind first): the middle
// of the shorter one lies in the longer one.
[[nodiscard]] bool are_one_excitation(const ExcitationInBoth& pair, std::int64_t offset_ns);
// The amplitudes of sync have the ratio in both that they have in one; at one frequency only.
[[nodiscard]] std::optional<bool> levels_agree(const ExcitationInBoth& one,
                                               const ExcitationInBoth& other);

} // namespace dyncal::inline evaluation
