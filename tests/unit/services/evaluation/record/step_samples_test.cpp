#include "services/evaluation/record/step_samples.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/services/evaluation/feed.hpp"

namespace dyncal::inline evaluation {
namespace {

wire::SampleBlock block_of(std::size_t samples) {
  wire::SampleBlock block;
  block.source("dau");
  block.sample_count(static_cast<std::uint32_t>(samples));
  block.channel_count(2);
  block.values().resize(2 * samples);
  for (std::size_t i = 0; i < samples; ++i) {
    block.stamps_ns().push_back(static_cast<std::int64_t>(1000 + 10 * i));
    block.values()[i] = static_cast<double>(i);
    block.values()[samples + i] = -static_cast<double>(i);
  }
  block.stamp_flags().resize(samples, 0);
  return block;
}

TEST(StepSamples, AreViewsOfTheRecordWhenNothingIsLeftOut) {
  SourceRecord record("dau");
  tests::feed(record, block_of(2000));
  const StepSamples samples = select_samples(record, {1100, 20'000}, {1});
  ASSERT_EQ(samples.stamps_ns.size(), 1891U);
  EXPECT_EQ(samples.stamps_ns.data(), record.stamps_ns().data() + 10);
  ASSERT_EQ(samples.columns.size(), 1U);
  EXPECT_EQ(samples.columns[0].data(), record.column(1).data() + 10);
  EXPECT_EQ(samples.columns[0].size(), 1891U);
  EXPECT_EQ(samples.not_trusted, 0U);
}

TEST(StepSamples, AreEmptyWhereTheRecordHasNone) {
  SourceRecord record("dau");
  tests::feed(record, block_of(20));
  const StepSamples samples = select_samples(record, {5000, 6000}, {0, 1});
  EXPECT_TRUE(samples.stamps_ns.empty());
  ASSERT_EQ(samples.columns.size(), 2U);
  EXPECT_TRUE(samples.columns[1].empty());
}

TEST(StepSamples, CountFlaggedStampsThatLieFarAwayFromTheStep) {
  wire::SampleBlock block = block_of(2000);
  for (const std::size_t i : {5U, 300U, 301U, 302U, 1990U}) { // two of them outside of the step
    block.stamps_ns()[i] = i == 302 ? 1'000'000'000 : 0;
    block.stamp_flags()[i] = 128;
  }
  SourceRecord record("dau");
  tests::feed(record, block);
  const StepSamples samples = select_samples(record, {1100, 20'000}, {1});
  EXPECT_EQ(samples.stamps_ns.size(), 1888U);
  EXPECT_EQ(samples.not_trusted, 3U);
}

TEST(StepSamples, LeaveOutAndCountWhatIsNotTrustedNotMeasuredOrNotLater) {
  std::mt19937_64 random(1);
  wire::SampleBlock block = block_of(5000);
  for (std::size_t i = 0; i < 5000; ++i) {
    switch (random() % 60) {
    case 0:
      block.stamp_flags()[i] = 4;
      break;
    case 1:
      block.values()[i] = std::nan("");
      break;
    case 2:
      block.values()[5000 + i] = INFINITY;
      break;
    case 3:
      block.stamps_ns()[i] -= 40;
      break;
    default:
      break;
    }
  }
  SourceRecord record("dau");
  tests::feed(record, block);
  const TimeInterval interval{1207, 45'003};
  const StepSamples samples = select_samples(record, interval, {1, 0});

  std::vector<std::size_t> expected;
  std::uint64_t not_trusted = 0;
  std::uint64_t not_measured = 0;
  for (std::size_t i = 0; i < 5000; ++i) {
    const std::int64_t stamp_ns = block.stamps_ns()[i];
    if (stamp_ns < interval.begin_ns || stamp_ns > interval.end_ns) {
      continue;
    }
    const bool measured =
        std::isfinite(block.values()[i]) && std::isfinite(block.values()[5000 + i]);
    const bool later = expected.empty() || stamp_ns > block.stamps_ns()[expected.back()];
    if (block.stamp_flags()[i] == 0 && measured && later) {
      expected.push_back(i);
    } else {
      ++(block.stamp_flags()[i] == 0 && later ? not_measured : not_trusted);
    }
  }
  EXPECT_GT(not_trusted, 50U);
  EXPECT_GT(not_measured, 50U);
  EXPECT_EQ(samples.not_trusted, not_trusted);
  EXPECT_EQ(samples.not_measured, not_measured);
  ASSERT_EQ(samples.stamps_ns.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ASSERT_EQ(samples.stamps_ns[k], block.stamps_ns()[expected[k]]);
    ASSERT_EQ(samples.columns[0][k], block.values()[5000 + expected[k]]);
    ASSERT_EQ(samples.columns[1][k], block.values()[expected[k]]);
  }
}

} // namespace
} // namespace dyncal::inline evaluation
