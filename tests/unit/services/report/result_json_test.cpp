#include "services/report/run_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dyncal::services {
namespace {

using testing::HasSubstr;
using testing::Not;

TransferFunction function(const std::string& channel, double magnitude) {
  TransferFunction one;
  one.channel = channel;
  one.unit = R"(\one)";
  for (const char* text : {"10", "20"}) {
    FrequencyPoint point;
    point.frequency_text_hz = text;
    point.frequency_hz = std::stod(text);
    point.mean.magnitude = magnitude;
    point.mean.u_magnitude = 1e-3;
    point.mean.phase_rad = -0.5;
    point.mean.u_phase_rad = 2e-3;
    point.mean.repetitions = 3;
    one.points.push_back(point);
  }
  one.group_delay.emplace();
  one.group_delay->delay_s = 8.1e-3;
  one.group_delay->u_delay_s = 1e-6;
  return one;
}

RunOutcome outcome() {
  RunOutcome one;
  one.bench = "acc-1";
  one.run = "r1";
  one.planned_steps = 2;
  one.analysis_dds = "fastdds";
  StepResult result;
  result.channel = "dau/acceleration_z";
  result.step = 1;
  result.frequency_hz = 10.0;
  result.frequency_text_hz = "10";
  result.level_m_s2 = 2.75;
  result.repetition = 1;
  result.valid = true;
  result.magnitude = 1.0;
  result.samples = {{.source = "dau", .used = 3010}};
  one.results.push_back(result);
  result.valid = false;
  result.step = 2;
  result.frequency_text_hz = "20";
  result.problem = "no steady sine";
  one.results.push_back(result);
  one.transfer_functions = {function("dau/acceleration_z", 1.0),
                            function("dau/angular_velocity_x", 1e-4)};
  ClockReport clock{.source = "dau", .clock = {}};
  clock.clock.mean_interval_s = 996.96e-6;
  clock.clock.intervals = 1000;
  one.clock_reports.push_back(clock);
  return one;
}

TEST(RunReport, JsonHasTheFormOthersRead) {
  const auto json = result_json(outcome());
  EXPECT_EQ(json["bench"], "acc-1");
  EXPECT_EQ(json["method"], "sample-timestamping");
  EXPECT_EQ(json["dds"]["analysis"], "fastdds");
  const auto& point = json["points"][0];
  EXPECT_EQ(point["channel"], "dau/acceleration_z");
  EXPECT_DOUBLE_EQ(point["frequency_hz"], 10.0);
  EXPECT_DOUBLE_EQ(point["level_m_s2"], 2.75);
  EXPECT_EQ(point["samples"]["dau"], 3010);
  EXPECT_EQ(point["lost"], 0);
  EXPECT_EQ(json["transfer_function"][0]["repetitions"], 3);
  EXPECT_DOUBLE_EQ(json["group_delay"][0]["value_s"], 8.1e-3);
  EXPECT_EQ(json["sample_clock"][0]["count"], 1000);
}

// JSON cannot represent infinity, and 0 would say the contrary.
TEST(RunReport, InfiniteDegreesOfFreedomAreNull) {
  RunOutcome one = outcome();
  one.results.front().budget = {
      {.kind = analysis::ContributionKind::reference, .u_phase_rad = 1e-3},
      {.kind = analysis::ContributionKind::fit_noise,
       .subject = "the sensor",
       .degrees_of_freedom = 17.0}};
  const auto budget = result_json(one)["points"][0]["budget"];
  ASSERT_EQ(budget.size(), 2u);
  EXPECT_EQ(budget[0]["name"], "reference");
  EXPECT_TRUE(budget[0]["degrees_of_freedom"].is_null());
  EXPECT_EQ(budget[1]["name"], "noise of the sensor");
  EXPECT_EQ(budget[1]["degrees_of_freedom"], 17.0);
}

TEST(RunReport, TableShowsChannelsThatRespondAndNamesTheOthers) {
  const std::string table = result_table(outcome());
  EXPECT_THAT(table, HasSubstr("dau/acceleration_z\n"));
  EXPECT_THAT(table, HasSubstr("group delay 8.1 ms"));
  EXPECT_THAT(
      table, HasSubstr("No response above three times its uncertainty in: dau/angular_velocity_x"));
}

TEST(RunReport, TableListsWhatHasNoResultAndWhy) {
  EXPECT_THAT(result_table(outcome()), HasSubstr("step 2, 20 Hz: no steady sine"));
  EXPECT_THAT(result_table(outcome()), Not(HasSubstr("nan")));
}

TEST(RunReport, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_THAT(write_json("/nowhere/result.json", {}).error().message,
              HasSubstr("/nowhere/result.json: cannot write"));
}

} // namespace
} // namespace dyncal::services
