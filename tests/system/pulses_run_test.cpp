// A run whose analogue system has UTC by the pulses of a GPS receiver, beside sync: both links of
// the clocks count, and their difference is a closure.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"
#include "tests/system/test_folder.hpp"
#include "tests/system/truth_deviation.hpp"

namespace dyncal::tests {
namespace {

constexpr double covered = 4.0; // standard uncertainties
constexpr const char* axis = "acceleration_z";

LiveBenchSettings settings_of(const std::filesystem::path& folder, const std::string& pulses) {
  LiveBenchSettings settings{
      .bench_arguments = {"--seed", "7", "--frequencies", "40,80", "--levels", "10", "--acs-pulses",
                          "--adc-file", folder / "adc.json"},
      .excitation = "frequencies_hz = [\"40\", \"80\"]\nlevel = 10.0\nrepetitions = 2\n"
                    "settling_s = 0.5\nduration_s = 2.0\n"};
  settings.rest = "[corrections.adc]\nfile = \"adc.json\"\nchannel = \"ADC1\"\n"
                  "[sources.acs.pulses]\nchannel = \"pps\"\n" +
                  pulses;
  return settings;
}

nlohmann::json result_of(const std::filesystem::path& folder, const std::string& pulses) {
  LiveBench bench(folder, settings_of(folder, pulses));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "result.json"});
  EXPECT_EQ(run.wait(patience), 0) << run.errors();
  auto result = read_json(folder / "result.json");
  result["truth"] = bench.truth();
  return result;
}

nlohmann::json closure_of_links(const nlohmann::json& result) {
  for (const auto& one : result["channels"]) {
    for (const auto& closure : one["closures"]) {
      if (closure["kind"] == "clock_links") {
        return closure;
      }
    }
  }
  return {};
}

TEST(PulsesRun, LinksTheClocksByPulsesAndSync) {
  const auto result = result_of(fresh_folder_of_this_test(), "u_delay_s = 5e-8\n");
  EXPECT_EQ(points_near_truth(result, result["truth"], axis, covered), 4);
  const auto closure = closure_of_links(result);
  ASSERT_FALSE(closure.is_null()) << result["channels"].dump();
  EXPECT_EQ(closure["verdict"], "closes") << closure.dump();
  EXPECT_LT(closure["u"].get<double>(), 1e-6);
}

// A cable whose delay nobody has taken into account.
TEST(PulsesRun, ShowsADelayThatNobodyKnowsOf) {
  const auto result = result_of(fresh_folder_of_this_test(), "u_delay_s = 5e-8\ndelay_s = 2e-5\n");
  const auto closure = closure_of_links(result);
  ASSERT_FALSE(closure.is_null()) << result["channels"].dump();
  EXPECT_EQ(closure["verdict"], "open") << closure.dump();
  EXPECT_NEAR(std::abs(closure["value"].get<double>()), 2e-5, 2e-6);
}

} // namespace
} // namespace dyncal::tests
