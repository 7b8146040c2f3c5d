#include "analysis/clock/clock_steps.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

std::vector<std::int64_t> stamps(int samples, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise_ns(0.0, 20.0);
  std::vector<std::int64_t> result;
  for (int i = 0; i < samples; ++i) {
    result.push_back(std::llround(996'939.0 * i + noise_ns(random)));
  }
  return result;
}

TEST(ClockSteps, FindsWhereAndByHowMuch) {
  for (const std::int64_t size_ns : {20'000, -20'000, 300'000, -3'000'000, 1'500'000}) {
    auto moved = stamps(2000, 1);
    std::vector<std::uint8_t> flags(moved.size(), 0);
    for (std::size_t i = 700; i < moved.size(); ++i) {
      moved[i] += size_ns;
      flags[i] = moved[i] <= moved[699] ? 1 : 0; // as the order of stamps flags them
    }
    const auto steps = find_clock_steps(moved, flags);
    ASSERT_EQ(steps.size(), 1U) << size_ns;
    EXPECT_NEAR(steps[0].size_ns, static_cast<double>(size_ns), 200.0);
    EXPECT_LT(steps[0].sample - 700, 4U);
  }
}

TEST(ClockSteps, FindsNoneInWhatScattersOrIsMadeSo) {
  EXPECT_TRUE(find_clock_steps(stamps(2000, 2)).empty());
  EXPECT_TRUE(find_clock_steps({}).empty());
  auto lost = stamps(2000, 3);
  lost.erase(lost.begin() + 500, lost.begin() + 503);
  EXPECT_TRUE(find_clock_steps(lost).empty());
  auto late = stamps(2000, 4);
  late[800] += 250'000; // one late sample, and a bad stamp
  late[1200] += 200'000'000'000'000;
  EXPECT_TRUE(find_clock_steps(late).empty());
  auto ticks = stamps(600, 5);
  for (std::int64_t& stamp : ticks) {
    stamp = stamp / 500'000 * 500'000;
  }
  EXPECT_TRUE(find_clock_steps(ticks).empty());
  std::vector<std::int64_t> batches; // stamps filled in with the nominal interval
  for (int i = 0; i < 2000; ++i) {
    batches.push_back(996'939LL * (i / 200 * 200) + 1'000'000LL * (i % 200));
  }
  EXPECT_TRUE(find_clock_steps(batches).empty());
}

} // namespace
} // namespace dyncal::analysis
