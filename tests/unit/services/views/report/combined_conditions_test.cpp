#include "services/views/report/combined_conditions.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

LoggedCondition logged(const std::string& quantity, double low, double mean, double high,
                       const std::string& source = "room.csv") {
  return {.quantity = quantity,
          .unit = quantity == "temperature" ? "degC" : "%",
          .source = source,
          .count = 10,
          .minimum = low,
          .mean = mean,
          .maximum = high,
          .expanded = 0.3,
          .problem = {}};
}

StoredResult run_with(const std::string& name, std::vector<LoggedCondition> conditions) {
  StoredResult run;
  run.run = name;
  run.conditions = std::move(conditions);
  return run;
}

JournalEntry amendment(const std::string& key, const std::string& value) {
  return {JournalKind::amendment,
          "2026-03-02T00:00:00.000000000Z",
          {"B. Other", "other", "lab3"},
          "misread",
          {{key, "", value}}};
}

TEST(CombinedConditions, GoFromTheSmallestToTheLargestOfAllRuns) {
  std::mt19937 random(37);
  std::uniform_real_distribution<double> draw(18.0, 28.0);
  std::vector<StoredResult> runs;
  double sum = 0.0;
  double low = INFINITY;
  double high = -INFINITY;
  for (const char* name : {"R1", "R2", "R3", "R4"}) {
    std::vector<double> readings{draw(random), draw(random), draw(random)};
    std::ranges::sort(readings);
    runs.push_back(run_with(name, {logged("temperature", readings[0], readings[1], readings[2])}));
    sum += readings[1];
    low = std::min(low, readings[0]);
    high = std::max(high, readings[2]);
  }
  runs[1].conditions[0].expanded = 0.5;
  const auto all = conditions_of_all(runs);
  EXPECT_THAT(all, SizeIs(4));
  const auto joined = joined_condition(all, "temperature");
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->runs, 4U);
  EXPECT_EQ(joined->logged.minimum, low);
  EXPECT_EQ(joined->logged.maximum, high);
  EXPECT_NEAR(joined->logged.mean, sum / 4.0, 1e-12);
  EXPECT_EQ(joined->logged.expanded, 0.5);
  EXPECT_EQ(joined->logged.count, 40U);
  EXPECT_EQ(joined->logged.source, "room.csv");
  EXPECT_FALSE(joined_condition(all, "humidity"));
}

TEST(CombinedConditions, SayOfHowManyRunsTheyAre) {
  LoggedCondition nothing = logged("temperature", NAN, NAN, NAN);
  nothing.count = 0;
  nothing.problem = "no such file";
  const auto all = conditions_of_all(
      {run_with("R1", {logged("humidity", 40.0, 41.0, 42.0)}), run_with("R2", {}),
       run_with("R3", {nothing, logged("humidity", 50.0, 51.0, 52.0, "other.csv")})});
  const auto temperature = joined_condition(all, "temperature");
  ASSERT_TRUE(temperature);
  EXPECT_EQ(temperature->runs, 0U); // one was to log it, and could not
  EXPECT_EQ(temperature->logged.count, 0U);
  EXPECT_EQ(temperature->logged.problem, "run R3: no such file");
  const auto humidity = joined_condition(all, "humidity");
  ASSERT_TRUE(humidity);
  EXPECT_EQ(humidity->runs, 2U);
  EXPECT_EQ(humidity->logged.maximum, 52.0);
  EXPECT_EQ(humidity->logged.source, "room.csv, other.csv");
  EXPECT_THAT(conditions_of_all({run_with("R1", {}), run_with("R2", {})}), IsEmpty());
}

// A run that could not log it may be the first.
TEST(CombinedConditions, AreThoseOfTheRunsThatStateThem) {
  LoggedCondition nothing = logged("temperature", NAN, NAN, NAN);
  nothing.count = 0;
  const auto joined =
      joined_condition({nothing, logged("temperature", 22.0, 22.5, 23.0)}, "temperature");
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->runs, 1U);
  EXPECT_EQ(joined->logged.mean, 22.5);
  EXPECT_EQ(joined->logged.count, 10U);
}

// As the documents of each run have it.
TEST(CombinedConditions, TakeWhatWasAmended) {
  StoredResult first = run_with("R1", {logged("temperature", 29.0, 29.2, 29.5)});
  first.journal = {amendment("temperature_degc", "22.0"), amendment("U_temperature_k", "1.0")};
  StoredResult second = run_with("R2", {});
  second.journal = {amendment("pressure_hpa", "1013")};
  const auto all = conditions_of_all({first, second});
  ASSERT_THAT(all, SizeIs(2));
  EXPECT_EQ(all[0].minimum, 22.0);
  EXPECT_EQ(all[0].maximum, 22.0);
  EXPECT_EQ(all[0].expanded, 1.0);
  EXPECT_EQ(all[0].source, "B. Other");
  EXPECT_EQ(all[1].quantity, "pressure");
  EXPECT_EQ(all[1].unit, "hPa");
}

} // namespace
} // namespace dyncal::inline views
