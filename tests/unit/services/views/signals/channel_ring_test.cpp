#include "services/views/signals/channel_ring.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

void push(ChannelRing& ring, std::int64_t first_ns, std::int64_t interval_ns,
          const std::vector<double>& values, bool missing = false) {
  std::vector<std::int64_t> stamps_ns;
  for (std::size_t i = 0; i < values.size(); ++i) {
    stamps_ns.push_back(first_ns + static_cast<std::int64_t>(i) * interval_ns);
  }
  ring.push(stamps_ns, values, missing, first_ns);
}

TEST(ChannelRing, HoldsTheSmallestAndLargestOfEveryMillisecond) {
  ChannelRing ring;
  push(ring, 0, 250'000, {1.0, 5.0, -2.0, 0.0, 7.0});
  ASSERT_EQ(ring.extremes().size(), 2U);
  EXPECT_EQ(ring.extremes()[0].minimum, -2.0);
  EXPECT_EQ(ring.extremes()[0].maximum, 5.0);
  EXPECT_EQ(ring.extremes()[1].maximum, 7.0);
  EXPECT_DOUBLE_EQ(ring.rate_hz(), 4000.0);
}

TEST(ChannelRing, LeavesOutWhatWasNotMeasured) {
  ChannelRing ring;
  push(ring, 0, 1'000'000, {1.0, std::numeric_limits<double>::quiet_NaN(), 3.0});
  ASSERT_EQ(ring.samples().size(), 2U);
  EXPECT_EQ(ring.samples()[1].value, 3.0);
}

TEST(ChannelRing, IsBoundedHoweverMuchComes) {
  ChannelRing ring;
  const std::vector<double> block(1000, 1.0);
  for (std::int64_t i = 0; i < 300; ++i) {
    push(ring, i * 2'000'000'000, 2'000'000, block, true);
  }
  EXPECT_EQ(ring.samples().size(), ChannelRing::max_samples);
  EXPECT_EQ(ring.extremes().size(), ChannelRing::max_extremes);
  EXPECT_EQ(ring.gaps().size(), ChannelRing::max_gaps);
}

TEST(ChannelRing, BeginsAnewWhenTimeJumpsBack) {
  ChannelRing ring;
  push(ring, 5'000'000, 1'000'000, {1.0, 2.0});
  push(ring, 1'000'000, 1'000'000, {3.0});
  ASSERT_EQ(ring.samples().size(), 1U);
  EXPECT_EQ(ring.samples()[0].value, 3.0);
  EXPECT_TRUE(ring.gaps().empty());
}

TEST(ChannelRing, GivesTheNewestSamplesBehindAGap) {
  ChannelRing ring;
  push(ring, 0, 1'000'000, {1.0, 2.0, 3.0});
  push(ring, 9'000'000, 1'000'000, {4.0, 5.0}, true);
  const auto stretch = ring.newest_stretch(100);
  ASSERT_EQ(stretch.size(), 2U);
  EXPECT_EQ(stretch[0].value, 4.0);
  EXPECT_EQ(ring.newest_stretch(1).size(), 1U);
  ASSERT_EQ(ring.gaps().size(), 1U);
  EXPECT_EQ(ring.gaps()[0], (std::pair<std::int64_t, std::int64_t>(2'000'000, 9'000'000)));
}

} // namespace
} // namespace dyncal::inline views
