// A multi-sine as both systems record it, with known answer; reproducible from its seed.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "analysis/method/multisine_stamping.hpp"
#include "analysis/sine/schroeder_phases.hpp"

namespace dyncal::analysis {

// The 17 lines of reference: odd multiples of 0.1 Hz near the third octaves and their neighbours.
inline const std::vector<std::string> seventeen_lines_hz{
    "10.1", "12.3", "16.1", "20.3", "25.3",  "31.3",  "39.7",  "45.7", "49.1",
    "53.3", "63.1", "80.3", "98.7", "125.3", "159.7", "198.3", "248.3"};

struct SimulatedMultisine {
  std::vector<std::string> lines_hz = seventeen_lines_hz;
  double period_s = 10.0;
  double duration_s = 10.0;
  double quiet_s = 0.0;      // of it at either end, when nothing is excited
  double level_m_s2 = 14.8;  // of a line, as far as the stroke allows
  double stroke_m = 12.5e-3; // amplitude of a line at most
  double lost_line_hz = 0.0; // this one is not excited
  double magnitude = 0.95;   // of the sensor, at 0 Hz
  double corner_hz = 900.0;  // first order
  double delay_s = 1.1e-3;
  double second_order = 0.0; // at full scale, of the sensor
  double third_order = 0.0;
  double full_scale_m_s2 = 127.0;
  double end_stop_m_s2 = 1e9;
  double sensor_noise = 0.08;
  double reference_noise = 0.01;
  // What the reference measures, in SI; the motion of its table beside the excitation, in metres,
  // at 0.7 Hz, of a displacement alone.
  MotionQuantity reference = MotionQuantity::acceleration;
  double table_m = 0.0;
  double hum_hz = 0.0;
  double hum_m_s2 = 0.0;        // in the sensor alone
  double sync_v = 0.2;          // of a line
  double sync_step_v = 4.88e-3; // of the DAU's ADC
  double adc_lag_s = 1.2e-6;
  double acs_rate_hz = 5000.0;
  double acs_clock_rel = 5e-6;
  double dau_clock_rel = 30e-6;
  double dau_drift_rel = 0.0; // change of its rate over the record
  double generator_rel = -7e-6;
  double late_s = 0.05;     // the DAU's record begins so much later
  double lost_from_s = 0.0; // a gap in the DAU's record
  double lost_to_s = 0.0;
};

struct MultisineRecords {
  std::vector<std::int64_t> acs_ns;
  std::vector<double> reference;
  std::vector<double> sync_acs;
  std::vector<std::int64_t> dau_ns;
  std::vector<double> sensor;
  std::vector<double> sync_dau;
  std::vector<MultisineLine> excited;

  [[nodiscard]] MultisineStampingInput input(const SimulatedMultisine& bench) const {
    MultisineStampingInput made;
    for (const std::string& text : bench.lines_hz) {
      const Frequency frequency = *Frequency::parse(text);
      made.lines.push_back(
          {frequency, {.phase_lag_rad = frequency.angular() * bench.adc_lag_s}, {}});
    }
    made.period_s = bench.period_s;
    made.acs_stamps_ns = acs_ns;
    made.reference = {.name = "acs/reference", .values = reference};
    if (bench.reference != MotionQuantity::acceleration) {
      made.reference.motion = {.measured = bench.reference, .per = MotionQuantity::acceleration};
    }
    made.sync_acs = {.name = "acs/sync", .values = sync_acs};
    made.dau_stamps_ns = dau_ns;
    made.sync_dau = {.name = "dau/sync", .values = sync_dau, .resolution = bench.sync_step_v};
    made.dut = {{.name = "dau/sensor", .values = sensor}};
    return made;
  }
};

inline std::complex<double> true_response(const SimulatedMultisine& bench, double hz) {
  const double w = 2.0 * std::numbers::pi * hz;
  return bench.magnitude * std::polar(1.0, -w * bench.delay_s) /
         std::complex<double>(1.0, hz / bench.corner_hz);
}

// Each line goes through the sensor by itself; its non-linearity follows. Sync is the voltage that
// drives the exciter, whose response the lines of the reference do not show here.
inline MultisineRecords simulate(const SimulatedMultisine& bench, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(0.0, 1.0);
  constexpr double two_pi = 2.0 * std::numbers::pi;
  MultisineRecords made;
  std::vector<double> amplitudes;
  for (const std::string& text : bench.lines_hz) {
    const double hz = Frequency::parse(text)->hz();
    const double w = two_pi * hz;
    const double level = hz == bench.lost_line_hz ? 0.0 : bench.level_m_s2;
    made.excited.push_back({hz, std::min(level, bench.stroke_m * w * w), 0.0});
    amplitudes.push_back(made.excited.back().amplitude);
  }
  const std::vector<double> phases = schroeder_phases(amplitudes);
  for (std::size_t k = 0; k < phases.size(); ++k) {
    made.excited[k].phase_rad = phases[k];
  }
  const double start_s = bench.period_s * part(random);
  // Of all lines at a true time; `gain` of each.
  using Gain = std::function<std::complex<double>(const MultisineLine&)>;
  const auto sum = [&](double t, const Gain& gain) {
    std::complex<double> total;
    if (bench.quiet_s > 0.0 && (t < bench.quiet_s || t > bench.duration_s - bench.quiet_s)) {
      return 0.0;
    }
    for (const MultisineLine& line : made.excited) {
      const double turns = line.frequency_hz * (1.0 + bench.generator_rel) * (start_s + t);
      total += gain(line) * std::polar(1.0, two_pi * (turns - std::floor(turns)) + line.phase_rad);
    }
    return total.imag();
  };
  std::vector<std::complex<double>> responses;
  for (const MultisineLine& line : made.excited) {
    responses.push_back(line.amplitude * true_response(bench, line.frequency_hz));
  }
  const auto motion = [&](const MultisineLine& line) {
    return line.amplitude *
           motion_factor(MotionQuantity::acceleration, bench.reference, two_pi * line.frequency_hz);
  };
  const auto drive = [&](const MultisineLine&) { return std::complex<double>(bench.sync_v); };
  const auto felt = [&](const MultisineLine& line) {
    return responses[static_cast<std::size_t>(&line - made.excited.data())];
  };
  const auto count = static_cast<int>(bench.duration_s * bench.acs_rate_hz);
  for (int i = 0; i < count; ++i) {
    const double t = i / bench.acs_rate_hz;
    made.acs_ns.push_back(std::llround(1e9 * t));
    const double true_s = t * (1.0 - bench.acs_clock_rel);
    made.reference.push_back(sum(true_s, motion) + bench.reference_noise * normal(random) +
                             bench.table_m * std::sin(two_pi * 0.7 * true_s));
    made.sync_acs.push_back(sum(true_s, drive) + 1e-4 * normal(random));
  }
  const double hum_turns = part(random);
  double true_s = bench.late_s;
  while (true_s < bench.late_s + bench.duration_s) {
    true_s += 996.96e-6 * (1.0 + 1e-3 * normal(random));
    const double since = true_s - bench.late_s;
    if (since > bench.lost_from_s && since < bench.lost_to_s) {
      continue;
    }
    const double drift = 0.5 * bench.dau_drift_rel * since * since / bench.duration_s;
    made.dau_ns.push_back(1'700'000'000'123'456'789 +
                          std::llround(1e9 * (since * (1.0 + bench.dau_clock_rel) + drift)));
    double value = sum(true_s, felt);
    const double of_scale = value / bench.full_scale_m_s2;
    value += bench.full_scale_m_s2 * of_scale * of_scale *
             (bench.second_order + bench.third_order * of_scale);
    value += bench.hum_m_s2 * std::sin(two_pi * (bench.hum_hz * true_s + hum_turns));
    value = std::clamp(value, -bench.end_stop_m_s2, bench.end_stop_m_s2);
    // Noise of the converter behind the end stop is not there.
    made.sensor.push_back(std::abs(value) < bench.end_stop_m_s2
                              ? value + bench.sensor_noise * normal(random)
                              : value);
    const double sync = sum(true_s - bench.adc_lag_s, drive) + 1e-3 * normal(random);
    made.sync_dau.push_back(bench.sync_step_v * std::round(sync / bench.sync_step_v));
  }
  return made;
}

} // namespace dyncal::analysis
