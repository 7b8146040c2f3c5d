#include "drivers/interferometer/decimated_channels.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/drivers/interferometer/simulated_device.hpp"

namespace dyncal::tests {
namespace {

using drivers::RegularClock;
using drivers::SampleBlock;
using drivers::interferometer::DecimatedChannels;

SampleBlock sine(std::uint64_t first, std::size_t n) {
  SampleBlock block;
  block.first_sample = first;
  block.samples = n;
  block.clock = RegularClock{7, 1'000'000'000, 500'000};
  for (std::size_t i = 0; i < n; ++i) {
    block.values.push_back(std::sin(1e-3 * static_cast<double>(first + i)));
  }
  return block;
}

SampleBlock push(DecimatedChannels& channels, const SampleBlock& block) {
  const std::span<const double> columns[] = {block.values};
  return channels.push(block, columns);
}

// Whatever number the stream begins with, and however it is cut, sample k is that of k D.
TEST(DecimatedChannels, KeepNumberAndInstant) {
  std::mt19937_64 random(21);
  for (int draw = 0; draw < 20; ++draw) {
    const std::size_t factor = 1 + random() % 40;
    const SampleBlock record = sine(random() % 1000, 5000);
    DecimatedChannels channels(factor, 1);
    std::size_t outputs = 0;
    for (std::size_t at = 0; at < record.samples;) {
      const std::size_t n = std::min<std::size_t>(1 + random() % 700, record.samples - at);
      const SampleBlock output = push(channels, part_of(record, at, n));
      at += n;
      outputs += output.samples;
      for (std::size_t i = 0; i < output.samples; ++i) {
        const std::uint64_t number = output.first_sample + i;
        ASSERT_NEAR(output.values[i], std::sin(1e-3 * static_cast<double>(number * factor)), 1e-6);
        ASSERT_TRUE(output.clock);
        ASSERT_EQ(output.clock->stamp_ns(number), record.clock->stamp_ns(number * factor));
      }
    }
    EXPECT_GE(outputs, 5000 / factor - 21);
  }
}

TEST(DecimatedChannels, TakeStampsWhereThereIsNoClock) {
  SampleBlock record = sine(3, 2000);
  record.clock.reset();
  for (std::size_t i = 0; i < record.samples; ++i) {
    record.stamps_ns.push_back(static_cast<std::int64_t>(2003 * (i + 3) + i % 7));
    record.flags.push_back(i == 997 ? std::uint8_t{4} : std::uint8_t{0});
  }
  DecimatedChannels channels(10, 1);
  const SampleBlock output = push(channels, record);
  ASSERT_GT(output.samples, 150U);
  EXPECT_FALSE(output.clock);
  for (std::size_t i = 0; i < output.samples; ++i) {
    const std::size_t raw = (output.first_sample + i) * 10 - 3;
    EXPECT_EQ(output.stamps_ns[i], record.stamps_ns[raw]);
    EXPECT_EQ(output.flags[i], raw == 997 ? 4 : 0);
  }
}

TEST(DecimatedChannels, LoseTheirClockWhereItChanges) {
  const SampleBlock record = sine(0, 2000);
  SampleBlock first = part_of(record, 0, 1000);
  SampleBlock second = part_of(record, 1000, 1000);
  second.clock->origin_ns += 5;
  DecimatedChannels channels(10, 1);
  EXPECT_TRUE(push(channels, first).clock);
  const SampleBlock output = push(channels, second);
  ASSERT_EQ(output.stamps_ns.size(), output.samples);
  EXPECT_EQ(output.stamps_ns.back(),
            second.clock->stamp_ns((output.first_sample + output.samples - 1) * 10));
}

TEST(DecimatedChannels, SpreadWhatIsNoNumberNoFurtherThanTheFilter) {
  SampleBlock record = sine(0, 4000);
  record.values[2000] = std::numeric_limits<double>::quiet_NaN();
  DecimatedChannels channels(10, 1);
  const SampleBlock output = push(channels, record);
  for (std::size_t i = 0; i < output.samples; ++i) {
    const double distance = std::abs(static_cast<double>(output.first_sample + i) - 200.0);
    EXPECT_EQ(std::isnan(output.values[i]), distance <= 10.0) << i;
  }
}

} // namespace
} // namespace dyncal::tests
