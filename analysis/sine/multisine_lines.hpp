// Which frequencies may be excited together: lines of one periodic waveform that nothing else of
// the bench falls on.
//
// A waveform of period T has lines at k / T. What a slightly non-linear exciter or sensor makes of
// them falls on other lines of the same grid, and where that is an excited one it cannot be told
// from the excitation: the second and third harmonic, 2 k_a and 3 k_a, and the sums and differences
// k_a +- k_b. With odd k alone all products of second order are even (odd multisine; Pintelon and
// Schoukens, System Identification, 2nd ed., 4.3.2): they bias nothing, and the even lines show how
// large they are. Third order falls on odd lines whatever is chosen.
//
// Lines keep ten of the grid from each other, so that a fraction of the record tells them apart,
// and from the mains and its harmonics by 0.4 % (what a mains may be off) and two of the grid.
//
// Frequencies are decimal text in Hz, as Frequency::parse() takes it. Fails (invalid_argument)
// where the period is not 1 s to 100 s with a whole number of millihertz between its lines, a
// frequency is none, or (propose) nothing is free within 3 % of a wish; the sentence names it.
// Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/sine/mains.hpp"

namespace dyncal::analysis {

// How far a line may be from what was wished for.
inline constexpr double max_line_shift_rel = 0.03;
// Between two lines, in lines of the grid.
inline constexpr int min_line_distance = 10;

// One line for each wish, as near to it as the others allow, in their order.
[[nodiscard]] Expected<std::vector<std::string>>
propose_multisine_lines(std::span<const std::string> wishes_hz, double period_s,
                        std::span<const double> mains_hz = usual_mains_hz);

// Two lines at least. Refuses (invalid_argument) lines that are not of the period, even ones, and
// those that collide, all by name.
[[nodiscard]] Expected<void>
check_multisine_lines(std::span<const std::string> lines_hz, double period_s,
                      std::span<const double> mains_hz = usual_mains_hz);

} // namespace dyncal::analysis
