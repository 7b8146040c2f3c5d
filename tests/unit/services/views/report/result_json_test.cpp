#include "services/views/report/result_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

using testing::HasSubstr;
using tests::example_outcome;

TEST(ResultJson, HasTheFormOthersRead) {
  const auto json = result_json(example_outcome());
  EXPECT_EQ(json["schema"]["name"], "dyncal-result");
  EXPECT_EQ(json["schema"]["version"], result_schema_version);
  EXPECT_EQ(json["bench"], "acc-1");
  EXPECT_EQ(json["method"], "sample-timestamping");
  EXPECT_EQ(json["dds"]["analysis"], "fastdds");
  const auto& point = json["points"][0];
  EXPECT_EQ(point["channel"], "dau/acceleration_z");
  EXPECT_DOUBLE_EQ(point["frequency_hz"], 10.0);
  EXPECT_DOUBLE_EQ(point["level_m_s2"], 2.75);
  EXPECT_EQ(point["samples"]["dau"], 3010);
  EXPECT_EQ(point["lost"], 7);
  EXPECT_EQ(json["transfer_function"][0]["repetitions"], 3);
  EXPECT_DOUBLE_EQ(json["group_delay"][0]["value_s"], 8.1e-3);
  EXPECT_EQ(json["sample_clock"][0]["count"], 1000);
}

TEST(ResultJson, TellsWhoMeasuredWhatAndWhen) {
  const auto json = result_json(example_outcome());
  EXPECT_THAT(json["software"].get<std::string>(), HasSubstr("dyncal "));
  EXPECT_EQ(json["analysis"]["software"], "dyncal 1.2.3");
  EXPECT_EQ(json["began_utc"], "2023-11-14T22:13:20.000000012Z");
  EXPECT_EQ(json["ended_utc"], "2023-11-14T22:14:20.000000000Z");
  const auto& source = json["sources"][0];
  EXPECT_EQ(source["serial"], "42");
  EXPECT_EQ(source["firmware"], "2.1");
  EXPECT_TRUE(source["tick_s"].is_null()); // not known
  EXPECT_EQ(source["channels"][0]["quantity"], "acceleration");
  EXPECT_EQ(source["channels"][0]["unit"], R"(\metre\second\tothe{-2})");
  EXPECT_TRUE(source["channels"][1]["maximum"].is_null());
  EXPECT_EQ(json["roles"]["sync_dau"], "dau/sync");
  EXPECT_EQ(json["recipe"], "bench = \"acc-1\"\n");
}

TEST(ResultJson, UnknownTimesAreNull) {
  RunOutcome outcome = example_outcome();
  outcome.began_utc_ns = 0;
  EXPECT_TRUE(result_json(outcome)["began_utc"].is_null());
}

TEST(ResultJson, HasCorrectionsAndTheExcitationThatWasMeasured) {
  const auto json = result_json(example_outcome());
  const auto& point = json["points"][0];
  EXPECT_DOUBLE_EQ(point["measured_level_m_s2"], 2.7);
  EXPECT_DOUBLE_EQ(point["measured_frequency_hz"], 10.000001);
  EXPECT_DOUBLE_EQ(point["temperature_degc"], 23.5);
  EXPECT_EQ(point["fit"]["role"], "dut");
  const auto& step = json["steps"][0];
  ASSERT_EQ(step["fits"].size(), 2U);
  EXPECT_EQ(step["fits"][0]["role"], "reference");
  EXPECT_EQ(step["fits"][1]["role"], "sync_acs");
  EXPECT_DOUBLE_EQ(step["fits"][1]["amplitude"], 1.0);
  EXPECT_DOUBLE_EQ(step["fits"][1]["residual_rms"], 1e-3);
  ASSERT_EQ(step["corrections"].size(), 2U);
  EXPECT_EQ(step["corrections"][0]["name"], "reference_delay");
  EXPECT_NEAR(step["corrections"][0]["phase_rad"], -6.283e-5, 1e-8);
  EXPECT_EQ(step["corrections"][1]["name"], "adc_phase_lag");
  EXPECT_NEAR(step["corrections"][1]["phase_rad"], -2e-4, 1e-5);
  EXPECT_EQ(json["corrections"]["adc_calibration"].size(), 2U);
  EXPECT_TRUE(json["steps"][1]["fits"].empty()); // it has no result
}

TEST(ResultJson, DerivedNumbersHaveTheirCoverage) {
  RunOutcome outcome = example_outcome();
  auto& clock = outcome.clock_reports.at(0).clock;
  clock.mean_interval_s = 1e-3;
  clock.mean_rate_hz = 1000.0;
  clock.nominal_rate_hz = 1001.0;
  clock.u_mean_interval_s = 1e-9;
  clock.degrees_of_freedom_mean_interval = 6.0;
  clock.k_mean_interval = 2.52;
  const auto json = result_json(outcome);
  const auto& delay = json["group_delay"][0];
  EXPECT_DOUBLE_EQ(delay["u_s"], 1e-6);
  EXPECT_DOUBLE_EQ(delay["nu_eff"], 9.0);
  EXPECT_DOUBLE_EQ(delay["k"], 2.32);
  EXPECT_DOUBLE_EQ(delay["U_s"], 2.32e-6);
  EXPECT_DOUBLE_EQ(delay["U_intercept_rad"], 2.0 * 0.00087);
  EXPECT_TRUE(delay["nu_eff_intercept"].is_null());
  const auto& report = json["sample_clock"][0];
  EXPECT_DOUBLE_EQ(report["U_mean_interval_s"], 2.52e-9);
  EXPECT_DOUBLE_EQ(report["nu_eff"], 6.0);
  EXPECT_DOUBLE_EQ(report["rate_deviation_rel"], 1000.0 / 1001.0 - 1.0);
  EXPECT_NEAR(report["U_rate_deviation_rel"], 2.52e-6, 1e-8);
}

TEST(ResultJson, EventsHaveTheirPlace) {
  const auto clock = result_json(example_outcome())["sample_clock"][0];
  EXPECT_EQ(clock["event_count"], 1);
  EXPECT_EQ(clock["events"][0]["sample"], 300);
  EXPECT_DOUBLE_EQ(clock["events"][0]["time_s"], 0.299);
}

TEST(ResultJson, ExplainsEveryFlag) {
  const auto json = result_json(example_outcome());
  EXPECT_EQ(json["points"][0]["flags"][0], "dau: samples lost");
  EXPECT_EQ(json["points"][0]["flag_names"][0], "samples_lost");
  const auto& mean = json["transfer_function"][0];
  EXPECT_EQ(mean["flag_names"], nlohmann::ordered_json({"samples_lost", "polarity_inverted"}));
  EXPECT_EQ(json["transfer_function"][1]["flag_names"],
            nlohmann::ordered_json({"polarity_inverted"}));
  EXPECT_TRUE(json["transfer_function"][2]["flags"].empty()); // of the other channel
  EXPECT_EQ(json["channels"][0]["flag_names"][0], "polarity_inverted");
  ASSERT_EQ(json["flag_legend"].size(), 2U);
  EXPECT_EQ(json["flag_legend"][0]["name"], "samples_lost");
  EXPECT_EQ(json["flag_legend"][0]["sentences"][0], "dau: samples lost");
  EXPECT_THAT(json["flag_legend"][1]["meaning"].get<std::string>(), HasSubstr("phase tends to pi"));
}

// JSON cannot represent infinity, and 0 would say the contrary.
TEST(ResultJson, InfiniteDegreesOfFreedomAreNull) {
  const auto json = result_json(example_outcome());
  const auto budget = json["points"][0]["budget"];
  ASSERT_EQ(budget.size(), 2U);
  EXPECT_EQ(budget[0]["name"], "reference");
  EXPECT_TRUE(budget[0]["degrees_of_freedom"].is_null());
  EXPECT_EQ(budget[1]["name"], "noise of the sensor");
  EXPECT_EQ(budget[1]["degrees_of_freedom"], 17.0);
  EXPECT_TRUE(json["transfer_function"][0]["nu_eff_magnitude"].is_null());
}

TEST(ResultJson, AFileThatCannotBeWrittenIsAnError) {
  EXPECT_THAT(write_json("/nowhere/result.json", {}).error().message,
              HasSubstr("/nowhere/result.json: cannot be written"));
}

} // namespace
} // namespace dyncal::inline views
