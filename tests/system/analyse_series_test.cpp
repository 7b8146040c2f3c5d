// dyncal analyse on files of shots made by formula: series time stamping without network and
// without noise.
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

constexpr double frequency_hz = 80.0;
constexpr double w = 2.0 * std::numbers::pi * frequency_hz;
constexpr double reference_against_sync = 0.8;
constexpr double magnitude = 0.97;
constexpr double delay_s = 1.3e-3;
constexpr double dso_delay_s = 236e-9;
constexpr double rate_factor = 1.00305;
constexpr double beta_rad[] = {-0.021, -0.012, 0.004}; // of the three triggers

std::string trace_file(double beta) {
  std::string text =
      "# nominal_rate_hz = 200000\n# first_sample_s = -0.0125\n# unit = \\volt\nCH1\n";
  for (int i = 0; i < 5000; ++i) {
    text += fmt::format("{}\n", 5.0 * std::sin(w * (-0.0125 + i * 5e-6) + beta));
  }
  return text;
}

std::string series_file(double beta) {
  std::string text = "# device = recorder\n# nominal_rate_hz = 1000\ntemperature,z\n";
  for (int n = 0; n < 1000; ++n) {
    const double t = dso_delay_s + n / (1000.0 * rate_factor);
    text += fmt::format(
        "25,{}\n",
        10.0 * magnitude * std::sin(w * (t - delay_s) + beta + reference_against_sync) + 0.1);
  }
  return text;
}

class AnalyseSeries : public testing::Test {
protected:
  void SetUp() override {
    folder_ = fresh_folder(std::string("analyse-series-") +
                           testing::UnitTest::GetInstance()->current_test_info()->name());
    std::ofstream acs(folder_ / "acs.csv");
    acs << "t_ns,ref,sync\n";
    for (std::int64_t i = 0; i < 20'000; ++i) {
      const double t = static_cast<double>(i) * 50e-6;
      acs << fmt::format("{},{},{}\n", 50'000 * i,
                         10.0 * std::sin(w * t + 0.3 + reference_against_sync),
                         std::sin(w * t + 0.3));
    }
    for (const char* part : {"dso", "tss"}) {
      std::filesystem::create_directories(folder_ / part);
    }
    for (int shot = 1; shot <= 3; ++shot) {
      const std::string name = fmt::format("step-1-shot-{}.csv", shot);
      std::ofstream(folder_ / "dso" / name) << trace_file(beta_rad[shot - 1]);
      std::ofstream(folder_ / "tss" / name) << series_file(beta_rad[shot - 1]);
    }
    std::ofstream(folder_ / "bench.toml") << R"(bench = "files"
[excitation]
frequencies_hz = ["80"]
level = 10.0
window = "whole-record"
[sources.acs]
driver = "file"
path = "acs.csv"
units = { ref = "m/s^2", sync = "V" }
[sources.dso]
driver = "oscilloscope"
path = "dso"
channels = { CH1 = "sync" }
[sources.tss]
driver = "series"
path = "tss"
units = { z = "m/s^2" }
[method]
kind = "series-timestamping"
reference = "acs/ref"
sync_acs = "acs/sync"
sync_dso = "dso/sync"
dut = ["tss/z"]
shots = 3
frequency_search_rel = 0
[corrections]
dso_delay = { value_s = 236e-9, u_s = 1e-9 }
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1e-3
acs_delay_s = 1e-8
)";
  }

  int analyse() {
    ProgramRun run("dyncal",
                   {"analyse", folder_ / "bench.toml", "--output", folder_ / "result.json"},
                   folder_);
    const auto status = run.wait(patience);
    errors_ = run.errors();
    return status.value_or(-1);
  }

  std::filesystem::path folder_;
  std::string errors_;
};

TEST_F(AnalyseSeries, ShotsInFilesAreMetWithin1e10Radians) {
  ASSERT_EQ(analyse(), 0) << errors_;
  const auto json = read_json(folder_ / "result.json");
  ASSERT_EQ(json["points"].size(), 1U);
  const auto& point = json["points"][0];
  EXPECT_TRUE(point["valid"].get<bool>()) << point;
  EXPECT_NEAR(
      std::remainder(point["phase_rad"].get<double>() + w * delay_s, 2.0 * std::numbers::pi), 0.0,
      1e-10);
  EXPECT_NEAR(point["magnitude"].get<double>(), magnitude, 1e-10);
  EXPECT_NEAR(point["sample_rate_hz"].get<double>(), 1000.0 * rate_factor, 1e-8);
  EXPECT_EQ(point["samples"]["tss"], 3000);
  EXPECT_EQ(point["flags"], nlohmann::json::array());
}

TEST_F(AnalyseSeries, TheDelayFileOfTheOscilloscopeIsTakenOutWithItsUncertainty) {
  ASSERT_EQ(analyse(), 0) << errors_;
  const auto before = read_json(folder_ / "result.json")["points"][0];
  std::ofstream(folder_ / "dso-delay.json") << R"({"value_s": 736e-9, "u_s": 2e-9})";
  std::ifstream bench(folder_ / "bench.toml");
  std::string text{std::istreambuf_iterator<char>(bench), {}};
  const std::string value = "{ value_s = 236e-9, u_s = 1e-9 }";
  text.replace(text.find(value), value.size(), R"({ file = "dso-delay.json" })");
  std::ofstream(folder_ / "bench.toml") << text;
  ASSERT_EQ(analyse(), 0) << errors_;
  const auto after = read_json(folder_ / "result.json")["points"][0];
  EXPECT_NEAR(after["phase_rad"].get<double>() - before["phase_rad"].get<double>(), -w * 500e-9,
              1e-12);
  const auto u_of_delay = [](const nlohmann::json& point) {
    for (const auto& row : point["budget"]) {
      if (row["name"] == "trigger delay of the oscilloscope") {
        return row["u_phase_rad"].get<double>();
      }
    }
    return -1.0;
  };
  EXPECT_NEAR(u_of_delay(before), w * 1e-9, 1e-15);
  EXPECT_NEAR(u_of_delay(after), w * 2e-9, 1e-15);
}

TEST_F(AnalyseSeries, AFileThatIsBrokenIsNamed) {
  std::ofstream(folder_ / "tss" / "step-1-shot-2.csv") << "# nominal_rate_hz = 1000\nz\n1.0\nx\n";
  EXPECT_EQ(analyse(), 1);
  EXPECT_THAT(errors_, HasSubstr("step-1-shot-2.csv"));
}

TEST_F(AnalyseSeries, AFolderWithoutShotsIsNamed) {
  std::filesystem::remove_all(folder_ / "dso");
  std::filesystem::create_directories(folder_ / "dso");
  EXPECT_EQ(analyse(), 1);
  EXPECT_THAT(errors_, HasSubstr("holds 0 files named like step-1-shot-1.csv"));
}

TEST_F(AnalyseSeries, AShotOfWhichOneFileIsMissingIsLeftOutAndCounted) {
  std::filesystem::remove(folder_ / "tss" / "step-1-shot-3.csv");
  ASSERT_EQ(analyse(), 0) << errors_;
  EXPECT_THAT(read_json(folder_ / "result.json")["points"][0]["flags"].dump(),
              HasSubstr("2 of 3 shots"));
}

} // namespace
} // namespace dyncal::tests
