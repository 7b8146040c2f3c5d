// How much noise lengthens a phasor, and how to take it out (Rice's distribution).
//
// A phasor of amplitude A whose two components have independent normal noise of standard deviation
// s has the length R with
//
//   E R    = s sqrt(pi / 2) e^{-q / 2} ((1 + q) I_0(q / 2) + q I_1(q / 2)),   q = A^2 / (2 s^2)
//          ~ A + s^2 / (2 A)                                                  for A >> s
//   Var R  = A^2 + 2 s^2 - (E R)^2
//
// `amplitude_of_rice_mean` is the inverse of the first: a mean of lengths without what noise added
// to it; 0 where noise alone would be as long. Units are those of the phasor. Any thread.
#pragma once

namespace dyncal::analysis {

[[nodiscard]] double rice_mean(double amplitude, double sd);
[[nodiscard]] double rice_standard_deviation(double amplitude, double sd);
[[nodiscard]] double amplitude_of_rice_mean(double mean, double sd);

} // namespace dyncal::analysis
