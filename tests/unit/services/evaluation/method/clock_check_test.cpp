#include "services/evaluation/method/clock_check.hpp"

#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr int samples = 2000;
constexpr double frequency_hz = 80.0;

// One channel, 2000 samples, whose stamps step after the 600th.
SelectedChannels channels_with_step(std::int64_t size_ns) {
  auto record = std::make_shared<SourceRecord>("dau");
  drivers::SourceDescription description;
  description.channels.emplace_back().name = "z";
  record->describe(description);
  std::vector<std::int64_t> stamps;
  std::vector<std::uint8_t> flags;
  std::vector<double> values;
  for (int i = 0; i < samples; ++i) {
    const std::int64_t noise_ns = 13 * (i * 7919 % 5) - 26;
    stamps.push_back(std::llround(996'939.0 * i) + noise_ns + (i < 600 ? 0 : size_ns));
    flags.push_back(i >= 600 && stamps.back() <= stamps[599] ? 1 : 0);
    values.push_back(std::sin(2.0 * std::numbers::pi * frequency_hz * 996.939e-6 * i));
  }
  SourceBlock block;
  block.session = 1;
  block.samples = samples;
  block.channels = 1;
  block.stamps_ns = stamps;
  block.flags = flags;
  block.values = values;
  EXPECT_TRUE(record->add(block));
  return {SourceInterval{record, {0, 4'000'000'000}}, {ChannelName{"dau", "z"}}};
}

StepResult result() {
  StepResult result;
  result.magnitude = 1.0;
  result.u_magnitude = 1e-3;
  result.u_phase_rad = 2e-3;
  return result;
}

bool is_flagged(std::int64_t size_ns, bool linked_by_sync) {
  StepResult judged = result();
  add_clock_check(find_stepped_clock(channels_with_step(size_ns),
                                     analysis::Frequency::from_hz(frequency_hz), linked_by_sync),
                  judged);
  return !judged.flags.empty() && judged.flags.front().kind == ResultFlag::clock_stepped;
}

TEST(ClockCheck, SaysByHowMuchTheValueMayBeOff) {
  const auto stepped = find_stepped_clock(channels_with_step(300'000),
                                          analysis::Frequency::from_hz(frequency_hz), false);
  ASSERT_EQ(stepped.size(), 1U);
  const double turn = 2.0 * std::numbers::pi * frequency_hz * 300e-6;
  EXPECT_EQ(stepped[0].source, "dau");
  EXPECT_NEAR(stepped[0].phase_rad, 0.7 * turn, 1e-3); // against the first 30 %
  EXPECT_NEAR(stepped[0].magnitude_rel, 0.5 * 0.3 * 0.7 * turn * turn, 2e-4);
}

TEST(ClockCheck, FlagsAStepThatTurnsThePhase) {
  EXPECT_TRUE(is_flagged(20'000, false));
  EXPECT_TRUE(is_flagged(-300'000, false));
  EXPECT_TRUE(is_flagged(-3'000'000, false));
  EXPECT_FALSE(is_flagged(1'500, false)); // 0.5 mrad at most, of which u is 2
  EXPECT_FALSE(is_flagged(0, false));
}

TEST(ClockCheck, BesideSyncOnlyTheMagnitudeCounts) {
  EXPECT_FALSE(is_flagged(20'000, true)); // 1e-5
  EXPECT_TRUE(is_flagged(300'000, true));
}

} // namespace
} // namespace dyncal::inline evaluation
