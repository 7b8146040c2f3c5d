#include "drivers/virtual_bench/model/channel_disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/virtual_bench/model/acs_instrument.hpp"
#include "drivers/virtual_bench/model/sensor_unit.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double interval_s = 1e-3;

std::vector<double> added(const ChannelFaults& faults, const Motion& motion) {
  const ChannelDisturbance disturbance(3, "sensor", faults, 20.0);
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) {
    values.push_back(disturbance.added(i * interval_s, motion));
  }
  return values;
}

TEST(ChannelDisturbance, AddsNothingAndHoldsNothingWithoutFaults) {
  ChannelDisturbance disturbance(3, "sensor", {}, 20.0);
  EXPECT_EQ(disturbance.added(0.4, {.sync_on = true, .since_change_s = 0.2}), 0.0);
  EXPECT_EQ(disturbance.held(1.5, 0.4), 1.5);
}

TEST(ChannelDisturbance, HumIsASineOfItsPartOfTheSignalWhetherTheGeneratorIsOnOrOff) {
  for (const bool on : {true, false}) {
    const auto values = added({.hum_rel = 0.01, .hum_hz = 60.0}, {.sync_on = on});
    double in_phase = 0.0;
    double in_quadrature = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double angle = 2.0 * M_PI * 60.0 * static_cast<double>(i) * interval_s;
      in_phase += 2e-3 * values[i] * std::cos(angle);
      in_quadrature += 2e-3 * values[i] * std::sin(angle);
    }
    EXPECT_NEAR(std::hypot(in_phase, in_quadrature), 0.01 * 20.0, 1e-9);
  }
}

TEST(ChannelDisturbance, DriftRisesWithTheTimeSinceTheGeneratorWasChanged) {
  const ChannelFaults faults{.drift_rel_per_s = 0.02};
  EXPECT_NEAR(added(faults, {.sync_on = true, .since_change_s = 1.5}).front(), 0.02 * 1.5 * 20.0,
              1e-12);
  EXPECT_EQ(added(faults, {.sync_on = false, .since_change_s = 1.5}).front(), 0.0);
}

TEST(ChannelDisturbance, SoftEndsCutTheSignalAtEither) {
  const ChannelDisturbance both(3, "sensor", {.soft_upper = 9.0, .soft_lower = 8.0}, 20.0);
  EXPECT_EQ(both.cut(9.5), 9.0);
  EXPECT_EQ(both.cut(-9.5), -8.0);
  EXPECT_EQ(both.cut(3.0), 3.0);
  EXPECT_EQ(ChannelDisturbance(3, "sensor", {.soft_upper = 9.0}, 20.0).cut(-9.5), -9.5);
  const ChannelDisturbance curved(3, "sensor", {.second_order_rel = 0.01}, 20.0);
  EXPECT_DOUBLE_EQ(curved.cut(20.0), 20.2);
  EXPECT_DOUBLE_EQ(curved.cut(-10.0), -9.95);
}

TEST(ChannelDisturbance, HeldSamplesHaveTheValueOfTheOneBefore) {
  ChannelDisturbance disturbance(3, "sensor", {.held_part = 0.1}, 20.0);
  int held = 0;
  for (int i = 0; i < 10000; ++i) {
    const double value = disturbance.held(i, i * interval_s);
    EXPECT_TRUE(value == i || value == i - 1) << value;
    held += value == i - 1 ? 1 : 0;
  }
  EXPECT_NEAR(held, 1000, 120);
}

TEST(ChannelDisturbance, StuckRepeatsOneValueForSoManySamplesEverySoOften) {
  ChannelDisturbance disturbance(3, "sensor", {.stuck_samples = 50, .stuck_every_s = 0.25}, 20.0);
  int wrong = 0;
  std::vector<int> runs;
  for (int i = 0; i < 1000; ++i) {
    const double value = disturbance.held(i, i * interval_s);
    const bool held = value != i;
    wrong += held ? 1 : 0;
    if (held && value == i - 1) {
      runs.push_back(i - 1);
    }
  }
  EXPECT_EQ(runs.size(), 4U);
  EXPECT_EQ(wrong, 4 * 49); // the first of each run has its own value
}

AcsSettings acs_settings() {
  AcsSettings settings;
  settings.seed = 3;
  settings.rate_hz = 1000;
  settings.highest_level_m_s2 = 20.0;
  return settings;
}

TEST(AcsFaults, EndStopsAreThoseThatTheDescriptionStates) {
  AcsSettings settings = acs_settings();
  settings.reference_faults.range = 5.0;
  settings.sync_faults.range = 4.0;
  AcsInstrument acs(settings);
  Excitation excitation{ExciterModel{}};
  excitation.change(0.0, {.frequency_hz = 40.0, .amplitude_v = 0.4, .on = true});
  AcsSamples samples;
  acs.sample_until(1.0, excitation, samples);
  double highest_reference = 0.0;
  double highest_sync = 0.0;
  for (std::size_t i = 0; i < samples.samples(); ++i) {
    highest_reference = std::max(highest_reference, samples.counts[2 * i] * acs.reference_scale());
    highest_sync = std::max(highest_sync, samples.counts[2 * i + 1] * acs.sync_scale());
  }
  EXPECT_NEAR(highest_reference, 5.0, 1e-5);
  EXPECT_NEAR(highest_sync, 4.0, 1e-5);
  EXPECT_NE(acs.description_line().find("\"maximum\":5.0"), std::string::npos);
  EXPECT_NE(acs.description_line().find("\"maximum\":4.0"), std::string::npos);
}

// Numbers of the samples that arrive, over 1000 frames of one sample.
std::vector<std::uint64_t> numbers_sent(bool counted) {
  AcsSettings settings = acs_settings();
  settings.loss = {.probability = 0.1, .counted = counted};
  AcsInstrument acs(settings);
  const Excitation excitation{ExciterModel{}};
  std::vector<std::uint64_t> numbers;
  for (int i = 0; i < 1000; ++i) {
    AcsSamples frame;
    acs.sample_until((i + 0.5) * interval_s, excitation, frame);
    EXPECT_EQ(frame.samples(), 1U);
    if (acs.sends(frame)) {
      numbers.push_back(frame.first_sample);
    }
  }
  return numbers;
}

TEST(AcsFaults, NumbersShowCountedLossesAndHideTheOthers) {
  const auto counted = numbers_sent(true);
  EXPECT_NEAR(static_cast<double>(counted.size()), 900.0, 40.0);
  EXPECT_GT(counted.back(), 990U);
  const auto hidden = numbers_sent(false);
  ASSERT_EQ(hidden.size(), counted.size());
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    ASSERT_EQ(hidden[i], i);
  }
}

SensorUnitSettings unit_settings() {
  SensorUnitSettings settings;
  settings.preset = *preset_by_name("mpu9250-ptb");
  settings.seed = 3;
  settings.start_ns = 1'600'000'000'000'000'000;
  settings.highest_level_m_s2 = 20.0;
  return settings;
}

std::vector<UnitSample> samples_of(const SensorUnitSettings& settings) {
  SensorUnit unit(settings);
  const Excitation excitation{ExciterModel{}};
  std::vector<UnitSample> samples;
  while (auto sample = unit.next_before(2.0, excitation)) {
    samples.push_back(*sample);
  }
  return samples;
}

TEST(SensorFaults, NumbersShowCountedLossesAndHideTheOthers) {
  SensorUnitSettings settings = unit_settings();
  settings.loss = {.probability = 0.1, .counted = true};
  const auto counted = samples_of(settings);
  EXPECT_NEAR(static_cast<double>(counted.size()), 0.9 * 2006.0, 60.0);
  EXPECT_GT(counted.back().sample_number, 1990U);
  settings.loss.counted = false;
  const auto hidden = samples_of(settings);
  ASSERT_EQ(hidden.size(), counted.size());
  EXPECT_EQ(hidden.back().sample_number, hidden.size());
  EXPECT_EQ(hidden.back().utc_ns, counted.back().utc_ns); // the stamps are true
}

TEST(SensorFaults, StuckHoldsAllAxesAtOnceAndRangeIsTheOneAskedFor) {
  SensorUnitSettings settings = unit_settings();
  settings.sensor_faults = {.range = 10.0, .stuck_samples = 100, .stuck_every_s = 1e3};
  const auto samples = samples_of(settings);
  EXPECT_NEAR(SensorUnit(settings).range_m_s2(), 10.0, 1e-12);
  EXPECT_LE(*samples[0].data[2], 10.0F); // gravity and the offset reach the end
  settings.sensor_faults.stuck_every_s = 0.5;
  const auto stuck = samples_of(settings);
  std::size_t longest = 0;
  std::size_t run = 0;
  for (std::size_t i = 1; i < stuck.size(); ++i) {
    run = stuck[i].data[0] == stuck[i - 1].data[0] && stuck[i].data[1] == stuck[i - 1].data[1]
              ? run + 1
              : 0;
    longest = std::max(longest, run);
  }
  EXPECT_EQ(longest, 99U);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
