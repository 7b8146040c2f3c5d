#include "services/views/live/laboratory_json.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/bus/memory/stepped_clock.hpp"
#include "services/views/live/run_json.hpp"
#include "tests/unit/services/network/messages.hpp"

namespace dyncal::inline views::live {
namespace {

using namespace network;
using Json = nlohmann::ordered_json;

TEST(LaboratoryJson, TellsOfABenchWhatItIsAndWhy) {
  bus::SteppedClock clock;
  network::BusState laboratory(clock);
  laboratory.take(status_of("acc-1", "dau", wire::SOURCE_FAILED));
  laboratory.take(measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
  laboratory.take(excitation_of("acc-1", "r1", 2, wire::EXCITATION_STEADY));
  laboratory.take(result_of("acc-1", "r1", 1, 0.1));
  const Json json = Json::parse(json_text(laboratory_json(laboratory)));
  ASSERT_EQ(json["benches"].size(), 1U);
  const Json& tile = json["benches"][0];
  EXPECT_EQ(tile["bench"], "acc-1");
  EXPECT_EQ(tile["state"], "running");
  EXPECT_EQ(tile["step"], 2);
  EXPECT_EQ(tile["step_count"], 2);
  EXPECT_EQ(tile["time_left_s"], 10.0);
  EXPECT_EQ(tile["worst"]["severity"], "error");
  EXPECT_EQ(tile["worst"]["what"], "dau: failed");
  EXPECT_EQ(tile["last_result"]["magnitude"], 0.1);
  EXPECT_EQ(json["now_utc_ms"], 1.8e12);
  const Json bench = bench_json(laboratory, *laboratory.bench("acc-1"));
  ASSERT_EQ(bench["sources"].size(), 1U);
  EXPECT_EQ(bench["sources"][0]["received"], "12345");
  EXPECT_EQ(bench["plan"]["steps"][1]["state"], "steady");
  EXPECT_EQ(bench["now"]["state"], "steady");
  EXPECT_EQ(bench["messages"].size(), json["events"].size());
}

TEST(LaboratoryJson, NamesTheBenchOfAProgram) {
  bus::SteppedClock clock;
  network::BusState laboratory(clock);
  laboratory.take(analysis_of("acc-1", "r1", wire::ARM_ARMED, wire::HEALTH_FAILED));
  DiscoveredProgram program;
  program.identity = {"dyncal-analysis", "lab-1", 1, "dyncal 9", "cyclonedds"};
  program.clock = ClockOffset{0.25, 0.001};
  laboratory.set_programs({program}, {{"lab-1", *program.clock}});
  const Json programs = laboratory_json(laboratory)["programs"];
  ASSERT_EQ(programs.size(), 1U);
  EXPECT_EQ(programs[0]["kind"], "analysis");
  EXPECT_EQ(programs[0]["bench"], "acc-1");
  EXPECT_EQ(programs[0]["health"], "failed");
  EXPECT_EQ(programs[0]["clock_offset_s"], 0.25);
  EXPECT_EQ(programs[0]["clock_offset_bound_s"], 0.001);
  const Json bench = laboratory_json(laboratory)["benches"][0];
  EXPECT_EQ(bench["clock_offset_s"], 0.25) << "of a service's host, where no source is";
  EXPECT_EQ(bench["clock_offset_bound_s"], 0.001);
}

TEST(LaboratoryJson, TellsOfAnAnalysisThatDiedInARunButNotOfOneWhoseRunIsOver) {
  bus::SteppedClock clock;
  network::BusState laboratory(clock);
  DiscoveredProgram program;
  program.identity = {"dyncal-analysis", "lab-1", 1, "dyncal 9", "cyclonedds"};
  laboratory.set_programs({program}, {});
  const auto hear = [&](wire::MeasurementState state) {
    laboratory.take(measurement_of("acc-1", "r1", state));
  };
  hear(wire::MEASUREMENT_RUNNING);
  laboratory.take(analysis_of("acc-1", "r1", wire::ARM_ARMED));
  const auto health = [&] { return laboratory_json(laboratory)["programs"][0]["health"]; };
  clock.advance(network::silence_limit);
  hear(wire::MEASUREMENT_RUNNING);
  EXPECT_EQ(health(), "ok");
  clock.advance(std::chrono::milliseconds(1));
  EXPECT_EQ(health(), "silent");
  const Json worst = laboratory_json(laboratory)["benches"][0]["worst"];
  EXPECT_EQ(worst["severity"], "stale");
  EXPECT_EQ(worst["what"], "dyncal-analysis:1@lab-1 has not been heard for 2 s");
  hear(wire::MEASUREMENT_DONE);
  EXPECT_EQ(health(), "ok") << "it reports while it serves a run";
}

TEST(LaboratoryJson, LeavesHostileTextsTextAndReplacesWhatIsNotUtf8) {
  bus::SteppedClock clock;
  network::BusState laboratory(clock);
  const std::string name = "<script>alert(1)</script>";
  wire::SourceStatus status = status_of(name, "\"><img src=x>\xff\xfe");
  status.message("</script>\n\u2028");
  laboratory.take(status);
  const Json json = Json::parse(json_text(bench_json(laboratory, *laboratory.bench(name))));
  EXPECT_EQ(json["bench"], name);
  EXPECT_EQ(json["sources"][0]["message"], "</script>??") << "one line";
  EXPECT_EQ(json["sources"][0]["source"], "\"><img src=x>\uFFFD\uFFFD");
}

TEST(RunJson, CarriesEveryDigitAndNullForWhatIsNotANumber) {
  bus::SteppedClock clock;
  network::BusState laboratory(clock);
  const double magnitude = 0.1 + 0.2;
  laboratory.take(result_of("acc-1", "r1", 1, magnitude));
  wire::CalibrationResult invalid =
      result_of("acc-1", "r1", 2, std::numeric_limits<double>::quiet_NaN());
  invalid.flags().emplace_back("dau: samples lost");
  invalid.flag_names().emplace_back("samples_lost");
  laboratory.take(invalid);
  const network::Bench& bench = *laboratory.bench("acc-1");
  const Json json = Json::parse(json_text(run_json(bench, bench.runs.at("r1"))));
  ASSERT_EQ(json["points"].size(), 2U);
  EXPECT_EQ(json["points"][0]["magnitude"].get<double>(), magnitude);
  EXPECT_TRUE(json["points"][1]["magnitude"].is_null());
  EXPECT_EQ(json["points"][1]["flag_names"][0], "samples_lost");
  EXPECT_EQ(json["flag_legend"][0]["name"], "samples_lost");
  EXPECT_NE(json["flag_legend"][0]["meaning"], "");
}

} // namespace
} // namespace dyncal::inline views::live
