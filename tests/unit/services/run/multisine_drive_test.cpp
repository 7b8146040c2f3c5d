#include "services/run/multisine_drive.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline run {
namespace {

using testing::HasSubstr;

BenchFile bench_of(std::vector<std::string> frequencies_hz, std::vector<double> levels_m_s2) {
  BenchFile bench;
  bench.method.reference = {"acs", "reference"};
  bench.excitation.multisine = {.period_s = 1.0};
  bench.excitation.frequencies_hz = std::move(frequencies_hz);
  bench.excitation.levels_m_s2 = std::move(levels_m_s2);
  bench.generator.level_per_volt = 50.0;
  return bench;
}

// Of the line at so many turns in the period.
double amplitude_of(const std::vector<double>& samples, int turns) {
  double sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * turns * static_cast<double>(i) /
                         static_cast<double>(samples.size());
    sine += samples[i] * std::sin(angle);
    cosine += samples[i] * std::cos(angle);
  }
  return 2.0 * std::hypot(sine, cosine) / static_cast<double>(samples.size());
}

TEST(MultisineDrive, GivesEachLineItsLevel) {
  const BenchFile bench = bench_of({"31", "25", "41"}, {5.0, 10.0, 20.0}); // in any order
  const MultisineDrive drive(bench);
  const std::vector<double> samples = drive.samples_v(0.5);
  EXPECT_EQ(static_cast<double>(samples.size()), drive.rate_hz() * drive.period_s());
  EXPECT_NEAR(amplitude_of(samples, 25), 0.1, 1e-12);
  EXPECT_NEAR(amplitude_of(samples, 31), 0.05, 1e-12);
  EXPECT_NEAR(amplitude_of(samples, 41), 0.2, 1e-12);
  EXPECT_NEAR(amplitude_of(samples, 37), 0.0, 1e-12);
  EXPECT_GT(drive.margin_s(), 2.0 / 6.0); // frames of two turns of lines 6 Hz apart
}

TEST(MultisineDrive, BringsEachLineToItsLevelByWhatTheReferenceHasShown) {
  const BenchFile bench = bench_of({"25", "31", "41"}, {10.0, 10.0, 10.0});
  MultisineDrive drive(bench);
  EXPECT_FALSE(drive.has_levels());
  ASSERT_TRUE(drive.take_levels({{"25", 4.0}, {"31", 5.0}, {"41", 7.5}}, 0.5));
  EXPECT_TRUE(drive.has_levels());
  const std::vector<double> samples = drive.samples_v(1.0);
  EXPECT_NEAR(amplitude_of(samples, 25), 0.2 / 0.8, 1e-12);
  EXPECT_NEAR(amplitude_of(samples, 31), 0.2, 1e-12);
  EXPECT_NEAR(amplitude_of(samples, 41), 0.2 / 1.5, 1e-12);
}

TEST(MultisineDrive, RefusesWhatTheLinesTogetherWouldPass) {
  BenchFile bench = bench_of({"25", "31", "41"}, {10.0, 10.0, 10.0});
  EXPECT_TRUE(MultisineDrive(bench).check());
  bench.generator.maximum_level_m_s2 = 11.0; // more than each line, less than their sum
  const auto checked = MultisineDrive(bench).check();
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::bad_argument);
  EXPECT_THAT(checked.error().message, HasSubstr("above generator.maximum_level_m_s2 = 11"));
  bench.generator.maximum_level_m_s2.reset();
  bench.generator.maximum_displacement_mm = 0.4; // 25 Hz alone is 0.405 mm
  EXPECT_THAT(MultisineDrive(bench).check().error().message, HasSubstr("maximum_displacement_mm"));
  bench.generator.maximum_displacement_mm.reset();
  bench.generator.maximum_voltage_v = 0.3;
  EXPECT_THAT(MultisineDrive(bench).check().error().message, HasSubstr("maximum_voltage_v"));
}

// Not of the sums of all lines, which never meet.
TEST(MultisineDrive, RefusesNothingThatItsPeaksDoNotReach) {
  const std::vector<std::string> lines{"25", "31", "35", "41", "47", "53"};
  BenchFile bench = bench_of(lines, std::vector<double>(lines.size(), 10.0));
  double sum_mm = 0.0;
  for (const std::string& line : lines) {
    sum_mm += 1e3 * 10.0 / std::pow(2.0 * std::numbers::pi * std::stod(line), 2.0);
  }
  bench.generator.maximum_displacement_mm = 0.95 * sum_mm;
  bench.generator.maximum_level_m_s2 = 50.0; // of 60
  bench.generator.maximum_voltage_v = 1.0;   // of 1.2
  const auto checked = MultisineDrive(bench).check();
  EXPECT_TRUE(checked) << checked.error().message;
}

TEST(MultisineDrive, DoesNotDriveByAReferenceThatShowsNoExcitation) {
  const BenchFile bench = bench_of({"25", "31", "41"}, {10.0, 10.0, 10.0});
  MultisineDrive drive(bench);
  const auto silent = drive.take_levels({{"25", 5.0}, {"31", 0.1}, {"41", 5.0}}, 0.5);
  ASSERT_FALSE(silent);
  EXPECT_THAT(silent.error().message, HasSubstr("shows 0.1 m/s^2 at 31 Hz"));
  MultisineDrive far(bench);
  const auto weak = far.take_levels({{"25", 1.0}, {"31", 1.0}, {"41", 1.0}}, 0.5);
  ASSERT_FALSE(weak);
  EXPECT_EQ(weak.error().code, ErrorCode::device);
  EXPECT_THAT(weak.error().message, HasSubstr("would need"));
}

} // namespace
} // namespace dyncal::inline run
