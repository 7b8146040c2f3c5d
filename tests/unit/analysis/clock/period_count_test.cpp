#include "analysis/clock/period_count.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double period_ns = 996'960.0;

std::int64_t stamp_of(int sample) {
  return std::llround(period_ns * sample);
}

PeriodCount settled(PeriodCount periods) {
  periods.finish();
  return periods;
}

TEST(PeriodCount, GoesAcrossSamplesThatTheNumberingShowsToBeMissing) {
  PeriodCount periods;
  for (int i = 0; i < 1000; ++i) {
    if (i % 10 != 3) {
      periods.add(static_cast<std::uint64_t>(i), stamp_of(i));
    }
  }
  EXPECT_EQ(periods.periods(), 999U);
  EXPECT_DOUBLE_EQ(periods.mean_ns(), period_ns);
  EXPECT_EQ(periods.unnumbered(), 0U);
}

TEST(PeriodCount, FindsWhatIsMissingWithoutNumbers) {
  PeriodCount periods;
  std::mt19937 random(1);
  std::normal_distribution<double> noise_ns(0.0, 20.0);
  std::uint64_t number = 0;
  std::uint64_t missing = 0;
  for (int i = 0; i < 10'000; ++i) {
    if (random() % 10 == 0 && i > 0 && i < 9999) {
      ++missing;
      continue;
    }
    const double noise = i == 0 || i == 9999 ? 0.0 : noise_ns(random);
    periods.add(number++, stamp_of(i) + std::llround(noise));
  }
  periods.finish();
  EXPECT_EQ(periods.periods(), 9999U);
  EXPECT_NEAR(periods.mean_ns(), period_ns, 1e-4);
  EXPECT_EQ(periods.unnumbered(), missing);
  std::uint64_t in_gaps = 0;
  for (const UnnumberedGap& gap : periods.take_gaps()) {
    in_gaps += gap.missing;
    EXPECT_NEAR(static_cast<double>(gap.after_ns - gap.before_ns),
                period_ns * static_cast<double>(gap.missing + 1), 200.0);
  }
  EXPECT_EQ(in_gaps, missing);
  EXPECT_TRUE(periods.take_gaps().empty());
}

TEST(PeriodCount, IsNotMovedByDuplicateAndBackwardStamps) {
  PeriodCount periods;
  for (int i = 0; i < 1000; ++i) {
    const bool duplicate = i % 50 == 20, backward = i % 50 == 40;
    periods.add(static_cast<std::uint64_t>(i), duplicate  ? stamp_of(i - 1)
                                               : backward ? stamp_of(i - 1) - 300'000
                                                          : stamp_of(i));
  }
  EXPECT_EQ(periods.periods(), 999U);
  EXPECT_DOUBLE_EQ(periods.mean_ns(), period_ns);
  EXPECT_EQ(periods.unnumbered(), 0U);
  EXPECT_EQ(periods.stretches(), 1U);
}

TEST(PeriodCount, LeavesOutAJumpOfTheClock) {
  PeriodCount periods;
  for (int i = 0; i < 1000; ++i) {
    periods.add(static_cast<std::uint64_t>(i), stamp_of(i) + (i < 500 ? 0 : 123'456'789'012));
  }
  EXPECT_EQ(periods.stretches(), 2U);
  EXPECT_NEAR(periods.mean_ns(), period_ns, 0.01);
  EXPECT_EQ(periods.unnumbered(), 0U);
}

TEST(PeriodCount, CountsNothingWhereThereIsNoPeriod) {
  PeriodCount periods;
  std::mt19937 random(2);
  std::int64_t stamp_ns = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    periods.add(i, stamp_ns += 1 + random() % 1'000'000);
  }
  EXPECT_FALSE(periods.knows_period());
  EXPECT_EQ(periods.periods(), 0U);
}

// Steps that come as stamps are made belong to the mean.
TEST(PeriodCount, GoesAcrossTheStepsOfCoarseTicks) {
  for (const std::int64_t tick_ns : {250'000, 500'000, 1'000'000}) {
    for (const double true_ns : {996'939.0, 2'493'765.0}) {
      PeriodCount periods;
      std::int64_t before_ns = -1;
      int last = 0;
      for (int i = 0; i < 13'000; ++i) {
        const std::int64_t stamp_ns = std::llround(true_ns * i + 7e6) / tick_ns * tick_ns;
        if (stamp_ns > before_ns) { // a repeated stamp is not trusted
          periods.add(static_cast<std::uint64_t>(i), stamp_ns);
          last = i;
        }
        before_ns = stamp_ns;
      }
      const double error_ns = periods.mean_ns() - true_ns;
      EXPECT_LE(std::abs(error_ns), static_cast<double>(tick_ns) / last) << tick_ns;
      EXPECT_EQ(periods.periods(), static_cast<std::uint64_t>(last)) << tick_ns;
      EXPECT_EQ(periods.unnumbered(), 0U) << tick_ns;
      EXPECT_EQ(periods.left_out_jumps(), 0U) << tick_ns;
      if (tick_ns > 250'000) {
        EXPECT_NEAR(periods.u_ends_ns(), static_cast<double>(tick_ns) / std::sqrt(6.0), 1.0);
      }
    }
  }
}

struct LossyTicks {
  double rate_hz;
  std::int64_t tick_ns;
  double lost; // part of all
};

struct IntervalOutcome {
  int known = 0;
  int covered = 0;
  double usual_u_ticks = 0.0; // of the distance of the first from the last
};

IntervalOutcome outcome_of(const LossyTicks& ticks, int draws) {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  IntervalOutcome outcome;
  std::vector<double> all_u;
  for (int draw = 0; draw < draws; ++draw) {
    const double true_ns = 1e9 / ticks.rate_hz * (1.0 + 4e-4 * (part(random) - 0.5));
    const double begin_ns = part(random) * static_cast<double>(ticks.tick_ns);
    PeriodCount periods;
    std::uint64_t number = 0;
    std::int64_t before_ns = -1;
    int losing = 0; // up to five at once
    for (int i = 0; i < 20'000; ++i) {
      if (losing == 0 && part(random) < ticks.lost / 3.0) {
        losing = 1 + static_cast<int>(5.0 * part(random));
      }
      if (losing > 0) {
        --losing;
        continue;
      }
      const auto stamp_ns =
          static_cast<std::int64_t>(true_ns * i + begin_ns) / ticks.tick_ns * ticks.tick_ns;
      if (stamp_ns > before_ns) { // a repeated stamp is not trusted
        periods.add(number, stamp_ns);
        before_ns = stamp_ns;
      }
      ++number;
    }
    periods.finish();
    if (periods.u_ends_ns() > 0.0) {
      const double error_ns =
          (periods.mean_ns() - true_ns) * static_cast<double>(periods.periods());
      ++outcome.known;
      outcome.covered += std::abs(error_ns) <= 2.0 * periods.u_ends_ns() ? 1 : 0;
      all_u.push_back(periods.u_ends_ns() / static_cast<double>(ticks.tick_ns));
    }
  }
  std::sort(all_u.begin(), all_u.end());
  outcome.usual_u_ticks = all_u.empty() ? 0.0 : all_u[all_u.size() / 2];
  return outcome;
}

// Losses that no number shows look like ticks, and hide where these lie.
TEST(PeriodCount, LossesBesideCoarseTicksAreCovered) {
  for (const LossyTicks& ticks :
       {LossyTicks{1003.05, 1'000'000, 0.01}, LossyTicks{1000.3, 1'000'000, 0.01},
        LossyTicks{997.05, 1'000'000, 0.01}, LossyTicks{1003.05, 500'000, 0.01}}) {
    const IntervalOutcome outcome = outcome_of(ticks, 20);
    EXPECT_GE(outcome.known, 10) << ticks.rate_hz << " " << ticks.tick_ns;
    EXPECT_GE(outcome.covered, outcome.known - 3) << ticks.rate_hz << " " << ticks.tick_ns;
  }
}

// Where the line is seen nothing is added.
TEST(PeriodCount, LossesBesideFinerTicksCostNothing) {
  for (const std::int64_t tick_ns : {250'000, 500'000}) {
    EXPECT_LT(outcome_of({1003.05, tick_ns, 0.01}, 20).usual_u_ticks, 0.5) << tick_ns;
  }
}

// A FIFO that is read every 200 samples, whose stamps are filled in with the nominal interval.
TEST(PeriodCount, GoesAcrossTheStepsOfBatches) {
  constexpr double true_ns = 996'939.0;
  constexpr int batch = 200;
  PeriodCount periods;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> latency_ns(0.0, 200e3);
  for (int first = 0; first < 6000; first += batch) {
    const std::int64_t read_ns = std::llround(true_ns * (first + batch - 1) + latency_ns(random));
    for (int i = 0; i < batch; ++i) {
      periods.add(static_cast<std::uint64_t>(first + i), read_ns - 1'000'000LL * (batch - 1 - i));
    }
  }
  EXPECT_EQ(periods.periods(), 5999U);
  EXPECT_EQ(periods.left_out_jumps(), 0U);
  EXPECT_NEAR(periods.mean_ns(), true_ns, 2.0 * periods.u_ends_ns() / 5999.0);
  EXPECT_LT(periods.u_ends_ns(), 700e3);
}

TEST(PeriodCount, CountsNothingOfABatchWithStampsSideBySide) {
  PeriodCount periods;
  for (int i = 0; i < 8000; ++i) {
    periods.add(static_cast<std::uint64_t>(i), stamp_of(i / 8 * 8 + 7) + 10 * (i % 8));
  }
  EXPECT_FALSE(periods.knows_period());
  EXPECT_EQ(periods.unnumbered(), 0U);
}

TEST(PeriodCount, CountsLongGapsAsFarAsThePeriodIsKnown) {
  for (const int missing : {999, 1000, 1001, 3109, 10'000}) {
    PeriodCount periods;
    std::mt19937 random(5);
    std::normal_distribution<double> noise_ns(0.0, 20.0);
    std::uint64_t number = 0;
    for (int i = 0; i < 30'000; ++i) {
      if (i < 3000 || i >= 3000 + missing) {
        periods.add(number++, stamp_of(i) + std::llround(noise_ns(random)));
      }
    }
    EXPECT_EQ(periods.unnumbered(), static_cast<std::uint64_t>(missing));
    EXPECT_EQ(periods.periods(), 29'999U) << missing;
    EXPECT_NEAR(periods.mean_ns(), period_ns, 0.01) << missing;
  }
}

TEST(PeriodCount, LeavesOutPausesThatAreTooLongToCount) {
  PeriodCount periods;
  std::uint64_t number = 0;
  for (int burst = 0; burst < 10; ++burst) {
    for (int i = 0; i < 2000; ++i) {
      periods.add(number++, stamp_of(i) + burst * 200'000'123'456LL);
    }
  }
  EXPECT_EQ(periods.left_out_jumps(), 9U);
  EXPECT_NEAR(periods.mean_ns(), period_ns, 0.01);
  EXPECT_EQ(periods.unnumbered(), 0U);
}

TEST(PeriodCount, ASmallStepOfTheClockIsLeftOutAndSaid) {
  for (const std::int64_t step_ns : {-3'000'000, 300'000, 1'500'000}) {
    PeriodCount periods;
    std::mt19937 random(6);
    std::normal_distribution<double> noise_ns(0.0, 20.0);
    for (int i = 0; i < 6000; ++i) {
      periods.add(static_cast<std::uint64_t>(i),
                  stamp_of(i) + std::llround(noise_ns(random)) + (i < 2500 ? 0 : step_ns));
    }
    EXPECT_EQ(periods.left_out_jumps(), 1U) << step_ns;
    EXPECT_NEAR(periods.largest_jump_ns(), static_cast<double>(step_ns), 200.0);
    EXPECT_NEAR(periods.mean_ns(), period_ns, 0.02) << step_ns;
  }
}

// The samples are complete, two stamps have changed places: nothing is missing.
TEST(PeriodCount, AStampOutOfPlaceIsNoLoss) {
  PeriodCount periods;
  for (int i = 0; i < 5000; ++i) {
    if (i % 500 != 21) { // is behind the one before, and so not trusted
      periods.add(static_cast<std::uint64_t>(i), stamp_of(i % 500 == 20 ? i + 1 : i));
    }
  }
  EXPECT_EQ(periods.unnumbered(), 0U);
  EXPECT_EQ(periods.periods(), 4999U);
  EXPECT_NEAR(periods.mean_ns(), period_ns, 1e-3);
}

TEST(PeriodCount, LearnsFromAFewWhenThereAreNoMore) {
  PeriodCount periods;
  for (const int i : {0, 1, 2, 5, 6}) {
    periods.add(static_cast<std::uint64_t>(i < 3 ? i : i - 2), stamp_of(i));
  }
  EXPECT_EQ(periods.periods(), 0U);
  EXPECT_EQ(settled(periods).periods(), 6U);
  EXPECT_EQ(settled(periods).unnumbered(), 2U);
}

} // namespace
} // namespace dyncal::analysis
