#include "analysis/clock/tick_gaps.hpp"

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr std::int64_t interval_ns = 1'000'000;

// Samples 1 ms apart by their stamps, and 2 ms behind each of these.
TickGaps gaps_behind(const std::vector<std::uint64_t>& samples) {
  TickGaps gaps(interval_ns, 0, 0);
  std::int64_t more = 0;
  for (const std::uint64_t one : samples) {
    const auto before_ns = (static_cast<std::int64_t>(one) + more) * interval_ns;
    gaps.add({one, one + 1, before_ns, before_ns + 2 * interval_ns, 1});
    ++more;
  }
  return gaps;
}

TEST(TickGaps, RegularGapsAreTicks) {
  const auto explained = gaps_behind({200, 532, 864, 1197}).explained();
  ASSERT_TRUE(explained);
  EXPECT_TRUE(explained->losses.empty());
  EXPECT_NEAR(explained->line.period_ns(), 1'003'009.0, 100.0);
}

TEST(TickGaps, ALossAmongTicksIsFound) {
  const auto explained = gaps_behind({200, 532, 700, 863, 1196, 1528, 1860}).explained();
  ASSERT_TRUE(explained);
  ASSERT_EQ(explained->losses.size(), 1U);
  EXPECT_EQ(explained->losses[0].before, 700U);
}

TEST(TickGaps, IrregularGapsAreLosses) {
  TickGaps gaps = gaps_behind({31, 60, 700, 733, 2100, 2900, 2930, 4000, 4001, 4500, 6000, 6600});
  EXPECT_FALSE(gaps.explained());
  EXPECT_TRUE(gaps.are_losses());
}

TEST(TickGaps, AFewAreNotDecided) {
  const TickGaps gaps = gaps_behind({200, 532, 864});
  EXPECT_FALSE(gaps.explained());
  EXPECT_TRUE(gaps.are_unsure());
  EXPECT_FALSE(gaps.are_losses());
}

TEST(TickGaps, StampsThatStrayShowALatency) {
  TickGaps gaps = gaps_behind({200, 480, 864, 1120}); // by up to a sixth of a tick
  EXPECT_FALSE(gaps.explained());
  EXPECT_FALSE(gaps.are_unsure());
  gaps.add_stray();
  ASSERT_TRUE(gaps.explained());
  EXPECT_FALSE(gaps.explained()->is_sure);
  EXPECT_TRUE(gaps.are_unsure());
  gaps.add_stray();
  gaps.add_stray();
  EXPECT_TRUE(gaps.explained()->is_sure);
  EXPECT_TRUE(gaps.line_to(1200, 1'204 * interval_ns));
}

TEST(TickGaps, AGapOfSeveralIsALoss) {
  TickGaps gaps = gaps_behind({200, 532, 864, 1197});
  const std::int64_t before_ns = (1300 + 4) * interval_ns;
  gaps.add({1300, 1301, before_ns, before_ns + 4 * interval_ns, 3});
  const auto explained = gaps.explained();
  ASSERT_TRUE(explained);
  ASSERT_EQ(explained->losses.size(), 1U);
  EXPECT_EQ(explained->losses[0].missing, 3U);
}

} // namespace
} // namespace dyncal::analysis
