#include "analysis/method/channels_of_one_clock.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double noise = 0.01;
constexpr std::size_t samples = 2000;

std::vector<std::int64_t> stamps() {
  std::vector<std::int64_t> result;
  for (std::size_t i = 0; i < samples; ++i) {
    result.push_back(1'000'000 * static_cast<std::int64_t>(i));
  }
  return result;
}

std::vector<double> sine(double amplitude, double phase_rad, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  std::vector<double> result;
  for (std::size_t i = 0; i < samples; ++i) { // 80.01 Hz
    result.push_back(
        amplitude *
            std::sin(2.0 * std::numbers::pi * 80.01e-3 * static_cast<double>(i) + phase_rad) +
        normal(random));
  }
  return result;
}

struct ChannelsOfOneClockTest : testing::Test {
  std::vector<std::int64_t> stamps_ns = stamps();
  std::vector<double> sync = sine(1.0, 0.0, 1), sensor = sine(4.0, 0.5, 2), quiet = sine(0, 0, 3);
  Frequency nominal = *Frequency::parse("80");
};

TEST_F(ChannelsOfOneClockTest, ThePilotGivesAllTheFrequencyAndThePhaseOrigin) {
  const std::array others{ChannelSamples{"sensor", sensor, 0.0}};
  const auto found = fit_channels_of_one_clock(nominal, 1e-3, stamps_ns, {"sync", sync}, others);
  ASSERT_TRUE(found.has_value()) << found.error().message;
  ASSERT_EQ(found->others.size(), 1u);
  const ChannelFit &pilot = found->pilot.result, &other = found->others[0].result;
  EXPECT_NEAR(pilot.frequency.hz(), 80.01, 4.0 * pilot.u_frequency_hz);
  EXPECT_EQ(other.frequency.hz(), pilot.frequency.hz());
  EXPECT_EQ(pilot.phase_origin_ns, 999'500'000);
  EXPECT_EQ(other.phase_origin_ns, pilot.phase_origin_ns);
  EXPECT_NEAR(std::arg(found->others[0].phasor() / found->pilot.phasor()), 0.5, 2e-3);
  EXPECT_EQ(found->others[0].values().data(), sensor.data()); // nothing had to be removed
}

// Three steps of signal without noise, and nobody said how large a step is.
TEST_F(ChannelsOfOneClockTest, AStepThatShowsInTheValuesIsInTheBudget) {
  std::vector<double> coarse;
  for (std::size_t i = 0; i < samples; ++i) {
    coarse.push_back(
        std::round(3.0 * std::sin(2.0 * std::numbers::pi * 80.01e-3 * static_cast<double>(i))));
  }
  const std::array others{ChannelSamples{"sensor", coarse, 0.0}};
  const auto found = fit_channels_of_one_clock(nominal, 1e-3, stamps_ns, {"sync", sync}, others);
  ASSERT_TRUE(found.has_value()) << found.error().message;
  Budget budget;
  add_sensor_rows(budget, found->others[0], 0.0);
  const double error_rel = std::abs(found->others[0].amplitude() / 3.0 - 1.0);
  EXPECT_GT(error_rel, 0.01);
  EXPECT_GT(2.0 * budget.u_magnitude_rel(), error_rel);
}

TEST_F(ChannelsOfOneClockTest, APilotWithoutExcitationIsRefusedByName) {
  const auto found = fit_channels_of_one_clock(nominal, 0.0, stamps_ns, {"dau/sync", quiet}, {});
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().code, ErrorCode::no_excitation);
  EXPECT_TRUE(found.error().message.starts_with("dau/sync: ")) << found.error().message;
}

TEST_F(ChannelsOfOneClockTest, ChannelsMustBeAsLongAsTheirStamps) {
  const std::array others{ChannelSamples{"short", std::span<const double>(sensor).first(7), 0.0}};
  const auto found = fit_channels_of_one_clock(nominal, 0.0, stamps_ns, {"sync", sync}, others);
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().code, ErrorCode::invalid_argument);
  EXPECT_TRUE(found.error().message.starts_with("short: ")) << found.error().message;
}

TEST_F(ChannelsOfOneClockTest, AStrongChannelHasNoiseAndQuantisationInItsBudget) {
  const auto found = fit_weak_channel(*Frequency::parse("80.01"), stamps_ns, {"s", sensor, 0.1});
  ASSERT_TRUE(found.has_value());
  Budget budget;
  add_signal_rows(budget, "the sensor", *found, 0.0, CountsIn::magnitude_and_phase);
  ASSERT_EQ(budget.rows().size(), 2u);
  EXPECT_EQ(budget.rows()[0].kind, ContributionKind::fit_noise);
  EXPECT_NEAR(budget.rows()[0].u_phase_rad, noise / 4.0 * std::sqrt(2.0 / samples), 2e-6);
  EXPECT_EQ(budget.rows()[1].kind, ContributionKind::quantisation);
  EXPECT_EQ(budget.rows()[1].distribution, Distribution::rectangular);
  Budget of_phase;
  add_signal_rows(of_phase, "sync", *found, 0.0, CountsIn::phase);
  EXPECT_EQ(of_phase.u_magnitude_rel(), 0.0);
  EXPECT_GT(of_phase.u_phase_rad(), 0.0);
}

// Six standard uncertainties: enough to be fitted, not enough for a pilot.
TEST_F(ChannelsOfOneClockTest, AWeakChannelIsLengthenedAsRiceSays) {
  const std::vector<double> weak = sine(6.0 * noise * std::sqrt(2.0 / samples), 0.0, 3);
  const auto found = fit_weak_channel(*Frequency::parse("80.01"), stamps_ns, {"s", weak});
  ASSERT_TRUE(found.has_value()) << found.error().message;
  const auto excited = require_excitation(*found);
  ASSERT_FALSE(excited.has_value());
  EXPECT_EQ(excited.error().code, ErrorCode::no_excitation);
  Budget budget;
  add_sensor_rows(budget, *found, 0.0);
  ASSERT_EQ(budget.rows().size(), 2u);
  EXPECT_EQ(budget.rows()[1].kind, ContributionKind::rice);
  EXPECT_NEAR(budget.rows()[1].u_magnitude_rel, 0.5 * std::pow(budget.rows()[0].u_magnitude_rel, 2),
              1e-15);
  EXPECT_GT(budget.rows()[0].u_phase_rad, 0.1);
}

TEST_F(ChannelsOfOneClockTest, NoiseAloneIsRefusedByName) {
  const auto found = fit_weak_channel(*Frequency::parse("80.01"), stamps_ns, {"can/z", quiet});
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error().code, ErrorCode::no_excitation);
  EXPECT_TRUE(found.error().message.starts_with("can/z: ")) << found.error().message;
}

} // namespace
} // namespace dyncal::analysis
