#include "services/run/multisine_drive.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/core.h>

#include "analysis/base/frequency.hpp"
#include "analysis/base/sine_motion.hpp"
#include "analysis/sine/schroeder_phases.hpp"
#include "drivers/generator/level_control.hpp"

namespace dyncal::inline run {
namespace {

constexpr double samples_of_a_turn = 32.0; // of the highest line, at least
constexpr double fewest_samples = 1 << 14;
constexpr double most_samples = 1 << 22;
constexpr double frames_of_margin = 5.0;
constexpr double turns_of_frame = 2.0;
constexpr double least_response = 1.0 / 20.0; // of the one that the bench file states
constexpr double mm = 1e3;

} // namespace

MultisineDrive::MultisineDrive(const BenchFile& bench)
    : bench_(bench), period_s_(bench.excitation.multisine->period_s) {
  const auto& excitation = bench.excitation;
  for (std::size_t i = 0; i < excitation.frequencies_hz.size(); ++i) {
    const std::string& text = excitation.frequencies_hz[i];
    lines_.push_back({text, analysis::Frequency::parse(text)->hz(), excitation.levels_m_s2[i],
                      bench.generator.level_per_volt});
  }
  std::ranges::sort(lines_, {}, &Line::frequency_hz);
  std::vector<double> levels;
  double nearest_hz = lines_.front().frequency_hz;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    levels.push_back(lines_[i].level_m_s2);
    nearest_hz = i > 0 ? std::min(nearest_hz, lines_[i].frequency_hz - lines_[i - 1].frequency_hz)
                       : nearest_hz;
  }
  const std::vector<double> phases = analysis::schroeder_phases(levels);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    lines_[i].phase_rad = phases[i];
  }
  margin_s_ = frames_of_margin * turns_of_frame / nearest_hz;
}

template <class Amplitude>
std::vector<double> MultisineDrive::waveform(Amplitude amplitude, double lead_rad) const {
  std::vector<analysis::MultisineLine> lines;
  for (const Line& line : lines_) {
    lines.push_back({line.frequency_hz, amplitude(line), line.phase_rad + lead_rad});
  }
  return analysis::multisine_waveform(
      lines, period_s_, static_cast<std::size_t>(std::llround(rate_hz() * period_s_)));
}

template <class Amplitude>
double MultisineDrive::peak(Amplitude amplitude, double lead_rad) const {
  const std::vector<double> samples = waveform(amplitude, lead_rad);
  const auto [lowest, highest] = std::ranges::minmax(samples);
  return std::max(-lowest, highest);
}

double MultisineDrive::peak_m_s2() const {
  return peak([](const Line& line) { return line.level_m_s2; });
}

double MultisineDrive::peak_v() const {
  return peak([](const Line& line) { return line.level_m_s2 / line.level_per_volt; });
}

// A power of two, which whoever takes such a waveform apart can do by halves.
double MultisineDrive::rate_hz() const {
  const double wanted = std::clamp(samples_of_a_turn * lines_.back().frequency_hz * period_s_,
                                   fewest_samples, most_samples);
  return static_cast<double>(std::bit_ceil(static_cast<std::uint64_t>(wanted))) / period_s_;
}

std::vector<double> MultisineDrive::samples_v(double part) const {
  return waveform([&](const Line& line) { return part * line.level_m_s2 / line.level_per_volt; });
}

std::vector<std::string> MultisineDrive::frequencies_hz() const {
  std::vector<std::string> texts;
  for (const Line& line : lines_) {
    texts.push_back(line.frequency_text_hz);
  }
  return texts;
}

Expected<void> MultisineDrive::check() const {
  const GeneratorSettings& generator = bench_.generator;
  const double velocity_m_s = peak(
      [](const Line& line) { return analysis::velocity_m_s(line.level_m_s2, line.frequency_hz); },
      -0.5 * std::numbers::pi);
  const double displacement_m = peak(
      [](const Line& line) { return analysis::displacement_m(line.level_m_s2, line.frequency_hz); },
      -std::numbers::pi);
  const struct {
    const char* key;
    std::optional<double> largest;
    double needed;
    const char* unit;
  } limits[] = {
      {"maximum_voltage_v", generator.maximum_voltage_v, peak_v(), "V"},
      {"maximum_level_m_s2", generator.maximum_level_m_s2, peak_m_s2(), "m/s^2"},
      {"maximum_velocity_m_s", generator.maximum_velocity_m_s, velocity_m_s, "m/s"},
      {"maximum_displacement_mm", generator.maximum_displacement_mm, mm * displacement_m, "mm"}};
  for (const auto& limit : limits) {
    if (limit.largest && limit.needed > *limit.largest) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("the {} lines of the multi-sine together come to {:.4g} {}, above "
                              "generator.{} = {:g}: lower the level",
                              lines_.size(), limit.needed, limit.unit, limit.key, *limit.largest));
    }
  }
  return {};
}

Expected<void> MultisineDrive::take_levels(const std::map<std::string, double>& levels_m_s2,
                                           double part) {
  for (Line& line : lines_) {
    const double measured_m_s2 = levels_m_s2.at(line.frequency_text_hz);
    const double expected_m_s2 = part * line.level_m_s2;
    if (!(measured_m_s2 >= least_response * expected_m_s2)) {
      return fail(ErrorCode::device,
                  fmt::format("{} shows {:.3g} m/s^2 at {} Hz where {:.3g} m/s^2 are expected: is "
                              "the amplifier on, and generator.level_per_volt right?",
                              bench_.method.reference.text(), measured_m_s2, line.frequency_text_hz,
                              expected_m_s2));
    }
    line.level_per_volt *= measured_m_s2 / expected_m_s2;
  }
  has_levels_ = true;
  const double largest_v = std::min(
      bench_.generator.maximum_voltage_v.value_or(std::numeric_limits<double>::infinity()),
      drivers::generator::plausible_level_m_s2(peak_m_s2()) / bench_.generator.level_per_volt);
  if (const double needed_v = peak_v(); needed_v > largest_v) {
    return fail(
        ErrorCode::device,
        fmt::format("the levels of the lines would need {:.3g} V, by what {} has shown, and "
                    "{:.3g} V are the most that is allowed or plausible; is "
                    "generator.level_per_volt right for this exciter?",
                    needed_v, bench_.method.reference.text(), largest_v));
  }
  return {};
}

} // namespace dyncal::inline run
