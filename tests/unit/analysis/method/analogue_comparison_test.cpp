#include "analysis/method/analogue_comparison.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double frequency_hz = 159.2;
constexpr double delay_s = 1.5e-3;
constexpr double magnitude = 0.4;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// y = A sin(w (t - later) + 0.3) at instants that lie `clock_offset_s` beside their stamps.
Record record(double amplitude, double later_s, double noise, double clock_offset_s, double rate_hz,
              double start_s, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Record result;
  for (int i = 0; i < static_cast<int>(2.0 * rate_hz); ++i) {
    const auto stamp_ns = static_cast<std::int64_t>(1'700'000'000'000'000'000) +
                          std::llround((start_s + i / rate_hz) * 1e9);
    const double t =
        static_cast<double>(stamp_ns - 1'700'000'000'000'000'000) * 1e-9 + clock_offset_s;
    result.stamps_ns.push_back(stamp_ns);
    result.values.push_back(amplitude * std::sin(2.0 * pi * frequency_hz * (t - later_s) + 0.3) +
                            noise * normal(random));
  }
  return result;
}

double true_phase() {
  return wrap_phase(-2.0 * pi * frequency_hz * delay_s);
}

TEST(AnalogueComparison, FindsTheQuotientOfTheTwoChannels) {
  int covered = 0;
  constexpr int runs = 200;
  for (unsigned run = 0; run < runs; ++run) {
    const Record reference = record(10.0, 0.0, 1e-2, 0.0, 5000.0, 0.0, 2 * run + 1);
    const Record dut = record(10.0 * magnitude, delay_s, 1e-2, 0.0, 5000.0, 0.0, 2 * run + 2);
    AnalogueInput input{.frequency = *Frequency::parse("159.2")};
    input.stamps_ns = reference.stamps_ns;
    input.reference = {"reference", reference.values};
    input.dut = {{"dut", dut.values}};
    const auto result = evaluate_analogue(input);
    ASSERT_TRUE(result.has_value()) << result.error().message;
    const TransferPoint& point = result->points[0];
    EXPECT_NEAR(point.magnitude, magnitude, 5.0 * point.u_magnitude);
    EXPECT_NEAR(point.phase_rad, true_phase(), 5.0 * point.u_phase_rad);
    covered += std::abs(point.phase_rad - true_phase()) <= 2.0 * point.u_phase_rad;
  }
  EXPECT_NEAR(covered / static_cast<double>(runs), 0.9545, 0.045);
}

TEST(AnalogueComparison, ADelayOfTheSensorIsNegativePhaseAndNotItsConjugate) {
  const Record reference = record(10.0, 0.0, 0.0, 0.0, 5000.0, 0.0, 1);
  const Record dut =
      record(-4.0, 1e-4, 0.0, 0.0, 5000.0, 0.0, 1); // inverted: A < 0 does not fold by pi
  AnalogueInput input{.frequency = *Frequency::parse("159.2")};
  input.stamps_ns = reference.stamps_ns;
  input.reference = {"reference", reference.values};
  input.dut = {{"dut", dut.values}};
  const auto result = evaluate_analogue(input);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->points[0].phase_rad, wrap_phase(pi - 2.0 * pi * frequency_hz * 1e-4), 1e-9);
}

TEST(AnalogueComparison, TakesOutAKnownDelayBetweenTheChannels) {
  const Record reference = record(10.0, 0.0, 0.0, 0.0, 5000.0, 0.0, 1);
  const Record dut = record(4.0, delay_s + 2e-6, 0.0, 0.0, 5000.0, 0.0, 1);
  AnalogueInput input{.frequency = *Frequency::parse("159.2")};
  input.stamps_ns = reference.stamps_ns;
  input.reference = {"reference", reference.values};
  input.dut = {{"dut", dut.values}};
  input.channel_delay_s = 2e-6;
  input.systematic = {.channel_delay_s = 1e-8};
  const auto result = evaluate_analogue(input);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->points[0].phase_rad, true_phase(), 1e-9);
  EXPECT_NEAR(result->points[0].u_phase_rad, 2.0 * pi * frequency_hz * 1e-8, 1e-9);
}

// The frequency is then that of the quieter sync; the ratio hardly depends on it.
TEST(AnalogueComparison, TakesTheFrequencyFromSync) {
  double frequency_gain = 0.0;
  constexpr int runs = 100;
  for (unsigned run = 0; run < runs; ++run) {
    const Record reference = record(10.0, 0.0, 1e-1, 0.0, 2000.0, 0.0, 3 * run + 1);
    const Record sync = record(1.0, 3e-4, 1e-3, 0.0, 2000.0, 0.0, 3 * run + 2);
    const Record dut = record(10.0 * magnitude, delay_s, 1e-1, 0.0, 2000.0, 0.0, 3 * run + 3);
    AnalogueInput input{.frequency = *Frequency::parse("159.2")};
    input.stamps_ns = reference.stamps_ns;
    input.reference = {"reference", reference.values};
    input.dut = {{"dut", dut.values}};
    const auto without = evaluate_analogue(input);
    input.sync = ChannelSamples{"sync", sync.values};
    const auto with = evaluate_analogue(input);
    ASSERT_TRUE(without && with);
    EXPECT_FALSE(without->sync);
    ASSERT_TRUE(with->sync);
    EXPECT_EQ(with->sync->channel, "sync");
    EXPECT_EQ(with->reference.frequency.hz(), with->sync->frequency.hz());
    ASSERT_EQ(with->points.size(), 1U);
    const TransferPoint &one = with->points[0], &other = without->points[0];
    EXPECT_EQ(one.channel, "dut");
    EXPECT_NEAR(one.magnitude, other.magnitude, 0.1 * other.u_magnitude);
    EXPECT_NEAR(one.phase_rad, other.phase_rad, 0.1 * other.u_phase_rad);
    EXPECT_NEAR(one.u_phase_rad / other.u_phase_rad, 1.0, 0.05);
    EXPECT_NEAR(with->sync->frequency.hz(), frequency_hz, 5.0 * with->sync->u_frequency_hz);
    frequency_gain += without->reference.u_frequency_hz / with->reference.u_frequency_hz / runs;
  }
  EXPECT_NEAR(frequency_gain, 10.0, 2.0);
}

TEST(AbsoluteTime, LinksTwoClocksOfOneTimeScaleWithoutSync) {
  const Record reference = record(10.0, 0.0, 1e-3, 0.0, 5000.0, 0.0, 1);
  const Record dut = record(10.0 * magnitude, delay_s, 1e-3, 0.0, 1003.049, 0.137, 2);
  AbsoluteTimeInput input{.frequency = *Frequency::parse("159.2")};
  input.reference_stamps_ns = reference.stamps_ns;
  input.reference = {"reference", reference.values};
  input.dut_stamps_ns = dut.stamps_ns;
  input.dut = {{"dut", dut.values}};
  const auto result = evaluate_absolute_time(input);
  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_NEAR(result->points[0].phase_rad, true_phase(), 4.0 * result->points[0].u_phase_rad);
  EXPECT_LT(result->points[0].u_phase_rad, 1e-4);
}

TEST(AbsoluteTime, TheClocksOffsetGoesInFullIntoThePhase) {
  const Record reference = record(10.0, 0.0, 1e-3, 0.0, 5000.0, 0.0, 1);
  const Record dut = record(10.0 * magnitude, delay_s, 1e-3, 5e-6, 1003.049, 0.0, 2);
  AbsoluteTimeInput input{.frequency = *Frequency::parse("159.2")};
  input.reference_stamps_ns = reference.stamps_ns;
  input.reference = {"reference", reference.values};
  input.dut_stamps_ns = dut.stamps_ns;
  input.dut = {{"dut", dut.values}};
  input.systematic.clock_offset_s = 5e-6;
  const auto result = evaluate_absolute_time(input);
  ASSERT_TRUE(result.has_value());
  const double shift = 2.0 * pi * frequency_hz * 5e-6;
  EXPECT_NEAR(result->points[0].phase_rad, true_phase() + shift, 1e-3);
  EXPECT_GE(result->points[0].u_phase_rad, shift);
}

// Stamps in the middle of ticks of 200 us, whose saw-tooth of 318.4 Hz is in step with 2 f.
TEST(AbsoluteTime, CoversTheTruthWhereTicksAreInStep) {
  int covered = 0, covered_without = 0;
  constexpr int runs = 50;
  for (unsigned run = 0; run < runs; ++run) {
    const Record reference = record(10.0, 0.0, 1e-3, 0.0, 5000.0, 0.0, 2 * run + 1);
    const double begin_s = 0.137 + 1.3e-5 * run;
    Record dut = record(10.0 * magnitude, delay_s, 1e-3, 0.0, 1063.68, begin_s, 2 * run + 2);
    for (std::int64_t& stamp_ns : dut.stamps_ns) {
      stamp_ns += 100'000 - stamp_ns % 200'000;
    }
    AbsoluteTimeInput input{.frequency = *Frequency::parse("159.2")};
    input.reference_stamps_ns = reference.stamps_ns;
    input.reference = {"reference", reference.values};
    input.dut_stamps_ns = dut.stamps_ns;
    input.dut = {{"dut", dut.values}};
    const auto result = evaluate_absolute_time(input);
    ASSERT_TRUE(result.has_value()) << result.error().message;
    const TransferPoint& point = result->points[0];
    double without = 0.0, of_ticks = 0.0;
    for (const Contribution& row : point.budget) {
      (row.kind == ContributionKind::stamp_tick ? of_ticks : without) +=
          row.u_phase_rad * row.u_phase_rad;
    }
    const double error = std::abs(point.phase_rad - true_phase());
    covered += error <= 2.0 * point.u_phase_rad;
    covered_without += error <= 2.0 * std::sqrt(without);
    EXPECT_GT(of_ticks, 0.0);
  }
  EXPECT_GE(covered, 47);
  EXPECT_LE(covered_without, 40); // there was something to allow for
}

TEST(AnalogueComparison, WithoutExcitationThereIsNoResult) {
  const Record reference = record(0.0, 0.0, 1.0, 0.0, 5000.0, 0.0, 1);
  AnalogueInput input{.frequency = *Frequency::parse("159.2")};
  input.stamps_ns = reference.stamps_ns;
  input.reference = {"reference", reference.values};
  input.dut = {{"dut", reference.values}};
  EXPECT_EQ(evaluate_analogue(input).error().code, ErrorCode::no_excitation);
}

} // namespace
} // namespace dyncal::analysis
