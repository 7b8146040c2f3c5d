#include "drivers/can/time/clock_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace dyncal::drivers::can {
namespace {

constexpr std::int64_t epoch_ns = 1'700'000'000'000'000'000;

// Readings at 1 kHz of a clock that runs `rate` slow against the host, late by a delay of
// exponential distribution.
struct Adapter {
  double rate = 50e-6;
  double mean_delay_s = 500e-6;
  std::mt19937 random{7};

  [[nodiscard]] static std::int64_t free_ns(int i) {
    return 5'000'000'000 + std::int64_t{i} * 1'000'000;
  }
  [[nodiscard]] std::int64_t truth_ns(int i) const {
    return epoch_ns + std::int64_t{i} * 1'000'000 + std::llround(i * 1e6 * rate);
  }
  [[nodiscard]] std::int64_t host_ns(int i) {
    return truth_ns(i) +
           std::llround(1e9 * std::exponential_distribution<>(1.0 / mean_delay_s)(random));
  }
};

TEST(ClockLine, FindsOffsetAndRateUnderDelaysMuchLargerThanItsError) {
  Adapter adapter;
  ClockLine line;
  for (int i = 0; i < 20'000; ++i) {
    line.add(Adapter::free_ns(i), adapter.host_ns(i));
  }
  ASSERT_TRUE(line.ready());
  EXPECT_NEAR(line.rate(), 50e-6, 0.2e-6);
  for (const int i : {5'000, 10'000, 19'999}) {
    EXPECT_NEAR(static_cast<double>(line.to_host(Adapter::free_ns(i)) - adapter.truth_ns(i)), 0.0,
                3000.0)
        << i;
  }
  EXPECT_GT(line.u_s(), 0.0);
  EXPECT_LT(line.u_s(), 20e-6);
}

// Over many adapters and all the time: seldom wrong by more than 2 u, and not by far.
TEST(ClockLine, KnowsHowUncertainItIsFromItsFirstAnswerOn) {
  int compared = 0;
  int beyond_2u = 0;
  double worst_in_u = 0.0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Adapter adapter;
    adapter.random.seed(seed);
    ClockLine line;
    for (int i = 0; i < 8'000; ++i) {
      line.add(Adapter::free_ns(i), adapter.host_ns(i));
      if (!line.ready()) {
        continue;
      }
      const double error_s =
          static_cast<double>(line.to_host(Adapter::free_ns(i)) - adapter.truth_ns(i)) * 1e-9;
      const double in_u = std::abs(error_s) / std::hypot(line.u_s(), 1e-9);
      ++compared;
      beyond_2u += in_u > 2.0 ? 1 : 0;
      worst_in_u = std::max(worst_in_u, in_u);
    }
  }
  EXPECT_LT(beyond_2u, compared / 20);
  EXPECT_LT(worst_in_u, 6.0);
}

TEST(ClockLine, SaysNothingExactOfAHandfulOfPoints) {
  Adapter adapter;
  ClockLine line;
  for (int i = 0; i < 50; ++i) {
    line.add(Adapter::free_ns(2'000 * i), adapter.host_ns(2'000 * i)); // every two seconds
    if (line.ready()) {
      EXPECT_GT(line.u_s(), 1e-6) << i;
    }
  }
  EXPECT_TRUE(line.ready());
}

TEST(ClockLine, IsExactWithoutDelays) {
  Adapter adapter;
  ClockLine line;
  for (int i = 0; i < 3'000; ++i) {
    line.add(Adapter::free_ns(i), adapter.truth_ns(i));
  }
  EXPECT_NEAR(static_cast<double>(line.to_host(Adapter::free_ns(2'999)) - adapter.truth_ns(2'999)),
              0.0, 2.0);
}

TEST(ClockLine, AnswersNothingBeforeItHasSettled) {
  Adapter adapter;
  ClockLine line;
  for (int i = 0; i < 900; ++i) {
    line.add(Adapter::free_ns(i), adapter.host_ns(i));
  }
  EXPECT_FALSE(line.ready());
}

TEST(ClockLine, BeginsAnewWhenTheHostClockIsSetEitherWay) {
  for (const std::int64_t step_ns : {-1'000'000'000LL, 1'000'000'000LL}) {
    Adapter adapter;
    ClockLine line;
    for (int i = 0; i < 5'000; ++i) {
      line.add(Adapter::free_ns(i), adapter.host_ns(i));
    }
    for (int i = 5'000; i < 10'000; ++i) {
      line.add(Adapter::free_ns(i), adapter.host_ns(i) + step_ns);
    }
    EXPECT_EQ(line.restarts(), 1U);
    ASSERT_TRUE(line.ready());
    EXPECT_NEAR(static_cast<double>(line.to_host(Adapter::free_ns(9'999)) -
                                    adapter.truth_ns(9'999) - step_ns),
                0.0, 5000.0);
  }
}

TEST(ClockLine, IsNotMovedBySingleFramesThatComeLate) {
  Adapter adapter;
  ClockLine line;
  for (int i = 0; i < 10'000; ++i) {
    line.add(Adapter::free_ns(i), adapter.host_ns(i) + (i % 50 == 0 ? 200'000'000 : 0));
  }
  EXPECT_EQ(line.restarts(), 0U);
  EXPECT_NEAR(static_cast<double>(line.to_host(Adapter::free_ns(9'999)) - adapter.truth_ns(9'999)),
              0.0, 5000.0);
}

} // namespace
} // namespace dyncal::drivers::can
