// Seventeen lines in ten seconds of the virtual bench, by its instruments with their converters,
// clocks, hum and harmonics, against what the bench says is true.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/method/multisine_stamping.hpp"
#include "analysis/sine/multisine_lines.hpp"
#include "analysis/sine/schroeder_phases.hpp"
#include "drivers/virtual_bench/model/virtual_bench.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double period_s = 10.0;
constexpr double level_m_s2 = 10.0;
constexpr int runs = 20;

const std::vector<std::string> wishes_hz{"10",  "12.5", "16",  "20",   "25", "31.5",
                                         "40",  "46.7", "50",  "53.3", "63", "80",
                                         "100", "125",  "160", "200",  "250"};

struct Recording {
  std::vector<std::int64_t> acs_stamps_ns;
  std::vector<double> reference;
  std::vector<double> sync_acs;
  std::vector<std::int64_t> dau_stamps_ns;
  std::vector<double> acceleration_z;
  std::vector<double> sync_dau;
};

Recording record(VirtualBench& bench, double duration_s) {
  Recording recording;
  AcsSamples acs;
  const double end_s = bench.now_s() + duration_s;
  while (bench.now_s() < end_s) {
    bench.advance_to(std::min(end_s, bench.now_s() + 0.1), acs, [&](const UnitSample& sample) {
      recording.dau_stamps_ns.push_back(sample.utc_ns);
      recording.acceleration_z.push_back(static_cast<double>(*sample.data[2]));
      recording.sync_dau.push_back(static_cast<double>(*sample.data[10]));
    });
  }
  for (std::size_t i = 0; i < acs.samples(); ++i) {
    recording.acs_stamps_ns.push_back(bench.acs().stamp_ns(acs.first_sample + i));
    recording.reference.push_back(acs.counts[2 * i] * bench.acs().reference_scale());
    recording.sync_acs.push_back(acs.counts[2 * i + 1] * bench.acs().sync_scale());
  }
  return recording;
}

VirtualBench bench_of(std::uint64_t seed) {
  BenchSettings settings;
  settings.preset = *preset_by_name("mpu9250-ptb");
  settings.seed = seed;
  settings.acs_rate_hz = 5000;
  settings.highest_level_m_s2 = 140.0;
  return VirtualBench(settings);
}

Drive drive_of(const std::vector<std::string>& lines_hz) {
  const std::vector<double> phases =
      analysis::schroeder_phases(std::vector<double>(lines_hz.size(), 1.0));
  Drive drive{.on = true};
  for (std::size_t i = 0; i < lines_hz.size(); ++i) {
    drive.lines.push_back({analysis::Frequency::parse(lines_hz[i])->hz(),
                           level_m_s2 / VirtualBench::level_per_volt, phases[i]});
  }
  return drive;
}

analysis::MultisineStampingInput input_of(const Recording& recording, const VirtualBench& bench,
                                          const std::vector<std::string>& lines_hz) {
  analysis::MultisineStampingInput input;
  for (const std::string& text : lines_hz) {
    const analysis::Frequency frequency = *analysis::Frequency::parse(text);
    input.lines.push_back(
        {frequency, {.phase_lag_rad = frequency.angular() * bench.adc().lag_s}, {}});
  }
  input.period_s = period_s;
  input.acs_stamps_ns = recording.acs_stamps_ns;
  input.reference = {.name = "reference", .values = recording.reference};
  input.sync_acs = {.name = "sync", .values = recording.sync_acs};
  input.dau_stamps_ns = recording.dau_stamps_ns;
  input.sync_dau = {.name = "sync", .values = recording.sync_dau};
  input.dut = {{.name = "z", .values = recording.acceleration_z}};
  input.systematic.dau_jitter_s = 20e-9;
  return input;
}

struct LineOfRuns {
  double magnitude_squares = 0.0;
  double phase_squares = 0.0;
};

// Issue 38: rms of 20 runs at most 1.5e-4 and 15 mdeg a line from 25 Hz to 250 Hz, each within 4 u.
TEST(VirtualBenchMultisine, SeventeenLinesInTenSeconds) {
  const auto lines_hz = analysis::propose_multisine_lines(wishes_hz, period_s);
  ASSERT_TRUE(lines_hz) << lines_hz.error().message;
  std::vector<LineOfRuns> all(lines_hz->size());
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    VirtualBench bench = bench_of(seed);
    const std::complex<double> reference_error = std::polar(
        1.0 + bench.acs().reference_gain_error(), bench.acs().reference_phase_error_rad());
    bench.set_drive(drive_of(*lines_hz));
    record(bench, 1.0); // settling
    const Recording recording = record(bench, period_s);
    const auto result =
        analysis::evaluate_multisine_stamping(input_of(recording, bench, *lines_hz));
    ASSERT_TRUE(result) << result.error().message;
    for (std::size_t k = 0; k < all.size(); ++k) {
      ASSERT_TRUE(result->lines[k]) << result->lines[k].error().message;
      const analysis::TransferPoint& point = result->lines[k]->points.front();
      const double hz = result->lines[k]->reference.frequency.hz();
      const std::complex<double> truth = bench.settings().preset.axes[2].at(hz) / reference_error;
      const double magnitude_rel = point.magnitude / std::abs(truth) - 1.0;
      const double phase_rad = std::arg(point.h / truth);
      EXPECT_LT(std::abs(magnitude_rel), 4.0 * point.u_magnitude / point.magnitude)
          << (*lines_hz)[k] << " Hz, seed " << seed;
      EXPECT_LT(std::abs(phase_rad), 4.0 * point.u_phase_rad)
          << (*lines_hz)[k] << " Hz, seed " << seed;
      all[k].magnitude_squares += magnitude_rel * magnitude_rel;
      all[k].phase_squares += phase_rad * phase_rad;
    }
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (analysis::Frequency::parse((*lines_hz)[k])->hz() >= 25.0) {
      EXPECT_LT(std::sqrt(all[k].magnitude_squares / runs), 1.5e-4) << (*lines_hz)[k] << " Hz";
      EXPECT_LT(std::sqrt(all[k].phase_squares / runs), 15e-3 * std::numbers::pi / 180.0)
          << (*lines_hz)[k] << " Hz";
    }
  }
}

TEST(VirtualBenchMultisine, EveryLineHasTheLevelOfItsVoltageAndNothingStaysBehind) {
  VirtualBench bench = bench_of(3);
  const std::vector<std::string> lines_hz{"10.1", "33.1", "80.3"};
  Drive drive = drive_of(lines_hz);
  bench.set_drive(drive);
  record(bench, 0.5);
  double squares = 0.0;
  const Recording on = record(bench, period_s);
  for (const double value : on.reference) {
    squares += value * value / static_cast<double>(on.reference.size());
  }
  EXPECT_NEAR(std::sqrt(squares), level_m_s2 * std::sqrt(1.5), 0.03 * level_m_s2);
  EXPECT_LT(*std::ranges::max_element(on.sync_acs), VirtualBench::sync_amplitude_v);
  drive.on = false;
  bench.set_drive(drive);
  record(bench, 1.0);
  const Recording off = record(bench, 0.5);
  EXPECT_LT(*std::ranges::max_element(off.reference), 0.1);
  bench.set_drive({40.0, 0.2, true}); // a sine again, alone
  record(bench, 0.5);
  const Recording sine = record(bench, 1.0);
  EXPECT_NEAR(*std::ranges::max_element(sine.reference), 10.0, 0.5);
  EXPECT_NEAR(*std::ranges::max_element(sine.sync_acs), VirtualBench::sync_amplitude_v, 0.01);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
