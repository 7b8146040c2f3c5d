// The waveform that excites all lines of a multi-sine at once, with the level of each.
//
//   u(t) = sum_k V_k sin(2 pi f_k t + phi_k),  V_k = a_k / r_k
//
//   a_k: planned level, m/s^2; r_k: level per volt, of the bench file at first, as measured when
//   the levels of a first record have been taken; phi_k: Schroeder's (schroeder_phases.hpp)
//
// Limits hold for the peaks of the sums: of the voltage, of the planned acceleration, and of the
// velocity and displacement that go with it, a quarter and half a turn behind. Fails: bad_argument
// (check(): a limit would be passed), device (take_levels(): the reference shows less than a
// twentieth of what is expected, as LevelControl, or what the corrected waveform needs is above a
// limit). Plain data; one thread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline run {

class MultisineDrive {
public:
  // REQUIRES: a multi-sine with lines that were checked.
  explicit MultisineDrive(const BenchFile& bench);

  [[nodiscard]] Expected<void> check() const;
  // Of all lines together.
  [[nodiscard]] double peak_m_s2() const;
  [[nodiscard]] double peak_v() const;

  // One period in volt, of this part of the levels; how many of its samples are a second.
  [[nodiscard]] std::vector<double> samples_v(double part) const;
  [[nodiscard]] double rate_hz() const;
  [[nodiscard]] double period_s() const { return period_s_; }
  // Time by which an excitation lasts longer than is evaluated, and that it is off before the next
  // (analysis/step/excitation_window.hpp: its frames are two turns of the nearest lines).
  [[nodiscard]] double margin_s() const { return margin_s_; }
  [[nodiscard]] std::vector<std::string> frequencies_hz() const;

  // What the reference has shown of each line, by its frequency, with this part of the levels.
  [[nodiscard]] Expected<void> take_levels(const std::map<std::string, double>& levels_m_s2,
                                           double part);
  [[nodiscard]] bool has_levels() const { return has_levels_; }

private:
  struct Line {
    std::string frequency_text_hz;
    double frequency_hz = 0.0;
    double level_m_s2 = 0.0;
    double level_per_volt = 0.0;
    double phase_rad = 0.0;
  };

  // Of the sum of all lines, each with its amplitude.
  template <class Amplitude>
  [[nodiscard]] double peak(Amplitude amplitude, double lead_rad = 0.0) const;
  template <class Amplitude>
  [[nodiscard]] std::vector<double> waveform(Amplitude amplitude, double lead_rad = 0.0) const;

  const BenchFile& bench_;
  std::vector<Line> lines_; // ascending
  double period_s_;
  double margin_s_ = 0.0;
  bool has_levels_ = false;
};

} // namespace dyncal::inline run
