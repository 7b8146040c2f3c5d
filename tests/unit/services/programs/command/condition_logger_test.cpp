#include "services/programs/command/condition_logger.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

namespace dyncal::inline programs {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t begin_ns = 1'772'366'400 * second_ns;

ConditionSummary temperature(double max_age_s) {
  ConditionSettings settings;
  settings.kind = "file";
  settings.name = "logger 174H";
  settings.file = "room.csv";
  settings.max_age_s = max_age_s;
  return {settings, {"temperature", "degC", "Temp", 0.4}};
}

Expected<ConditionReading> reading(std::int64_t at_s, double value) {
  return ConditionReading{begin_ns + at_s * second_ns, value};
}

TEST(ConditionSummary, IsOfAllReadings) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    std::mt19937 draw(seed);
    std::normal_distribution<double> value(23.0, 0.2);
    ConditionSummary summary = temperature(600.0);
    std::vector<double> values;
    for (int i = 0; i < 50; ++i) {
      values.push_back(value(draw));
      EXPECT_THAT(summary.take(reading(60 * i, values.back()), begin_ns + 60 * i * second_ns),
                  IsEmpty());
    }
    const LoggedCondition& logged = summary.logged();
    EXPECT_EQ(logged.count, 50U);
    EXPECT_EQ(logged.minimum, *std::ranges::min_element(values));
    EXPECT_EQ(logged.maximum, *std::ranges::max_element(values));
    EXPECT_NEAR(logged.mean, std::accumulate(values.begin(), values.end(), 0.0) / 50.0, 1e-12);
    EXPECT_EQ(logged.source, "logger 174H, file room.csv");
    EXPECT_THAT(logged.problem, IsEmpty());
  }
}

// The logger writes every ten minutes and is asked every minute.
TEST(ConditionSummary, CountsALineOfTheFileOnce) {
  ConditionSummary summary = temperature(900.0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns + 60 * i * second_ns), IsEmpty());
  }
  EXPECT_EQ(summary.logged().count, 1U);
}

TEST(ConditionSummary, SaysThatALoggerHasStoppedAndTakesNoOldValue) {
  ConditionSummary summary = temperature(600.0);
  EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns), IsEmpty());
  EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns + 601 * second_ns),
              HasSubstr("temperature (logger 174H, file room.csv) is not logged: the newest "
                        "reading is of 2026-03-01T12:00:00.000000000Z, 601 s ago"));
  EXPECT_THAT(summary.take(reading(0, 23.0), begin_ns + 661 * second_ns), IsEmpty()); // said once
  EXPECT_THAT(summary.take(reading(700, 24.0), begin_ns + 720 * second_ns),
              HasSubstr("logged again"));
  EXPECT_EQ(summary.logged().count, 2U);
  EXPECT_THAT(summary.logged().problem, HasSubstr("601 s ago"));
}

TEST(ConditionSummary, TakesNeitherTheFutureNorWhatCannotBe) {
  ConditionSummary summary = temperature(600.0);
  EXPECT_THAT(summary.take(reading(3600, 23.0), begin_ns), HasSubstr("3600 s after now"));
  ConditionSummary hot = temperature(600.0);
  EXPECT_THAT(hot.take(reading(0, 2300.0), begin_ns), HasSubstr("beyond what a laboratory has"));
  ConditionSummary absent = temperature(600.0);
  EXPECT_THAT(absent.take(fail(ErrorCode::bad_file, "room.csv: is not there"), begin_ns),
              HasSubstr("room.csv: is not there"));
  EXPECT_EQ(absent.logged().count, 0U);
  EXPECT_NE(absent.logged().mean, absent.logged().mean); // no number at all
}

TEST(JoinedConditions, AreOfARunThatWasResumed) {
  LoggedCondition before{.quantity = "temperature",
                         .unit = "degC",
                         .source = "s",
                         .count = 3,
                         .minimum = 20.0,
                         .mean = 21.0,
                         .maximum = 22.0,
                         .expanded = 0.4,
                         .problem = {}};
  LoggedCondition since = before;
  since.count = 1;
  since.minimum = since.mean = since.maximum = 25.0;
  const auto joined = joined_conditions({before}, {since});
  ASSERT_EQ(joined.size(), 1U);
  EXPECT_EQ(joined[0].count, 4U);
  EXPECT_EQ(joined[0].minimum, 20.0);
  EXPECT_EQ(joined[0].mean, 22.0);
  EXPECT_EQ(joined[0].maximum, 25.0);
  EXPECT_EQ(joined_conditions({}, {since})[0].count, 1U);
}

} // namespace
} // namespace dyncal::inline programs
