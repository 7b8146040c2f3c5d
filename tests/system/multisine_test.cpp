// A multi-sine from the records of the virtual bench to its results, through the programs.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"
#include "tests/system/truth_deviation.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

// As 'dyncal new-bench --multisine 10' proposes them for these wishes.
const std::vector<std::string> lines_hz{"10.1", "12.3",  "16.1",  "20.3",  "25.3", "31.3",
                                        "39.7", "45.7",  "49.1",  "53.3",  "63.1", "80.3",
                                        "98.7", "125.3", "159.7", "198.3", "248.3"};

class Multisine : public testing::Test {
protected:
  std::filesystem::path folder_ = fresh_folder(
      std::string("multisine-") + testing::UnitTest::GetInstance()->current_test_info()->name());

  EndedRun run(const std::string& program, const std::vector<std::string>& arguments) {
    return run_to_end(program, arguments, folder_);
  }

  void record(int repetitions, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"--preset",
                                       "mpu9250-ptb",
                                       "--seed",
                                       "11",
                                       "--record-csv",
                                       folder_,
                                       "--adc-file",
                                       folder_ / "adc.json",
                                       "--truth",
                                       folder_ / "truth.json",
                                       "--acs-rate",
                                       "5000",
                                       "--multisine",
                                       "10",
                                       "--frequencies",
                                       fmt::format("{}", fmt::join(lines_hz, ",")),
                                       "--levels",
                                       "10",
                                       "--repetitions",
                                       fmt::format("{}", repetitions),
                                       "--settling",
                                       "2",
                                       "--duration-per-step",
                                       "10"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const EndedRun recorded = run("dyncal-virtual-bench", arguments);
    ASSERT_EQ(recorded.status, 0) << recorded.errors;
  }

  std::filesystem::path bench_file(int repetitions, const std::string& generator = "") {
    std::ofstream(folder_ / "bench.toml")
        << fmt::format(R"(bench = "multisine"
[excitation]
kind = "multisine"
frequencies_hz = ["{}"]
level = 10.0
level_deviation_rel = 0.3
period_s = 10.0
dropped_periods = 0.2
repetitions = {}
{}[sources.dau]
driver = "file"
path = "dau.csv"
time_base = "utc"
units = {{ acceleration_z = "m/s^2", sync = "V" }}
[sources.acs]
driver = "file"
path = "acs.csv"
units = {{ reference = "m/s^2", sync = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[corrections]
adc = {{ file = "adc.json", channel = "ADC1" }}
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1.7e-3
acs_delay_s = 1e-8
)",
                       fmt::join(lines_hz, "\", \""), repetitions, generator);
    return folder_ / "bench.toml";
  }

  nlohmann::json analyse(int repetitions) {
    const EndedRun analysed =
        run("dyncal", {"analyse", bench_file(repetitions), "--output", folder_ / "result.json"});
    EXPECT_EQ(analysed.status, 0) << analysed.errors;
    return read_json(folder_ / "result.json");
  }
};

double distortion_of(const nlohmann::json& point, const std::string& channel) {
  for (const auto& signal : point["signals"]) {
    if (signal["channel"] == channel) {
      return signal["thd"];
    }
  }
  return -1.0;
}

TEST_F(Multisine, GivesEveryLineTheTruthWithinItsUncertainty) {
  record(2);
  const auto result = analyse(2);
  ASSERT_EQ(result["points"].size(), 2 * lines_hz.size());
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"]) << point["problem"];
    EXPECT_EQ(point["flags"].size(), 0U) << point["frequency_text_hz"] << point["flags"];
    EXPECT_EQ(point["unit"], "\\one");
  }
  ASSERT_EQ(result["transfer_function"].size(), lines_hz.size());
  const auto truth = read_json(folder_ / "truth.json");
  for (const auto& point : result["transfer_function"]) {
    EXPECT_LT(deviation_of_point(point, truth, "acceleration_z"), 4.0) << point;
  }
  // Of all lines, with the link of the clocks and the delay of the ADC in full.
  EXPECT_NEAR(result["group_delay"][0]["value_s"].get<double>(),
              truth["group_delay"][2]["value_s"].get<double>(),
              4.0 * result["group_delay"][0]["u_s"].get<double>());
}

// 0.1 % at the highest level.
TEST_F(Multisine, ShowsASecondOrderAsDistortionAndNotAsBias) {
  record(1);
  const auto sound = analyse(1);
  record(1, {"--fault", "second-order=0.001,at=sensor"});
  const auto curved = analyse(1);
  ASSERT_EQ(sound["points"].size(), lines_hz.size());
  ASSERT_EQ(curved["points"].size(), lines_hz.size());
  for (std::size_t i = 0; i < lines_hz.size(); ++i) {
    const auto& before = sound["points"][i];
    const auto& after = curved["points"][i];
    // The same noise in both: nothing is left of the difference but what the curve does.
    const double change =
        after["magnitude"].get<double>() / before["magnitude"].get<double>() - 1.0;
    EXPECT_LT(std::abs(change), 2e-5) << lines_hz[i];
    EXPECT_GT(distortion_of(after, "dau/acceleration_z"),
              distortion_of(before, "dau/acceleration_z"));
  }
}

} // namespace
} // namespace dyncal::tests
