// Amplitude spectrum of the newest samples of a channel, with distortion and noise, to look at.
//
// N samples, a power of two, at the mean rate f_s, minus their mean, times the four-term
// Blackman-Harris window w; X is their discrete Fourier transform:
//
//   amplitude of line k    2 |X_k| / sum(w), at k f_s / N
//   power of a sine        2 sum |X|^2 over the lines within 4 of it / (N sum(w^2)), amplitude^2/2
//   THD                    root of the power of harmonics 2 to 10 below f_s / 2, over that of the
//                          fundamental, which is the strongest line
//   noise floor            median amplitude of the lines that belong to none of them
//
// Fails (no_source) with fewer than 64 samples. Plain functions; any thread.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline views {

struct Spectrum {
  std::vector<std::pair<double, double>> lines; // Hz, amplitude; at most `max_lines`: peaks stay
  double fundamental_hz = 0.0;
  double amplitude = 0.0; // of the fundamental
  double thd = 0.0;
  double noise_floor = 0.0;
  double resolution_hz = 0.0; // width of a line in noise
};

inline constexpr std::size_t max_spectrum_lines = 4000;
inline constexpr std::size_t max_spectrum_samples = std::size_t{1} << 16U;
inline constexpr const char* spectrum_window = "blackman-harris";

// The newest of `values`, oldest first.
[[nodiscard]] Expected<Spectrum> spectrum_of(std::span<const double> values, double rate_hz,
                                             std::size_t max_lines = max_spectrum_lines);

} // namespace dyncal::inline views
