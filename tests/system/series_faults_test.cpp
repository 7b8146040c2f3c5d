// A run by series time stamping over bad instruments: every shot that fails is repeated, and the
// run reaches its result.
#include <chrono>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

class SeriesFaults : public testing::Test {
protected:
  // A virtual bench with `options`, the services, and a bench file for a run.
  void start(const std::string& name, const std::vector<std::string>& options) {
    folder_ = fresh_folder("series-faults-" + name);
    laboratory_.emplace(folder_);
    std::filesystem::create_directories(folder_ / "bench");
    std::vector<std::string> arguments{"--preset",      "tss",
                                       "--speed",       "8",
                                       "--frequencies", "40,160",
                                       "--levels",      "100",
                                       "--ports-file",  folder_ / "ports.json",
                                       "--truth",       folder_ / "truth.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    virtual_bench_.emplace("dyncal-virtual-bench", arguments, folder_ / "bench");
    ASSERT_TRUE(virtual_bench_->wait_for_error_text("ports", patience));
    write_bench_file(read_json(folder_ / "ports.json"));
    laboratory_->start("dyncal-analysis", {}, "fastdds");
    laboratory_->start("dyncal-acs", {folder_ / "bench.toml"}, "cyclonedds");
    dso_ = &laboratory_->start("dyncal-dso", {folder_ / "bench.toml"}, "fastdds");
  }

  void write_bench_file(const nlohmann::json& ports) const {
    const auto address = [&](const char* port) {
      return "\"127.0.0.1:" + ports[port].dump() + "\"\n";
    };
    std::ofstream(folder_ / "bench.toml")
        << "bench = \"series-faults\"\n[excitation]\nfrequencies_hz = [\"40\", \"160\"]\n"
        << "level = 100.0\nsettling_s = 0.5\nduration_s = 2.0\n"
        << "[generator]\ndriver = \"scpi\"\nlevel_per_volt = 50.0\naddress = "
        << address("generator")
        << "[sources.dso]\ndriver = \"oscilloscope\"\naddress = " << address("dso")
        << "[sources.tss]\ndriver = \"series\"\naddress = " << address("tss")
        << "[sources.acs]\ndriver = \"socket\"\naddress = " << address("acs")
        << "[method]\nkind = \"series-timestamping\"\nreference = \"acs/reference\"\n"
        << "sync_acs = \"acs/sync\"\nsync_dso = \"dso/sync\"\ndut = [\"tss/acceleration_z\"]\n"
        << "shots = 4\n[corrections]\ndso_delay = { value_s = 236e-9, u_s = 1e-9 }\n"
        << "[uncertainty]\nreference_magnitude_rel = 1e-3\nreference_phase_rad = 1.7e-3\n"
        << "acs_delay_s = 1e-8\n";
  }

  nlohmann::json run(int status = 0) {
    run_ = &laboratory_->start("dyncal",
                               {"run", folder_ / "bench.toml", "--output", folder_ / "result.json"},
                               "cyclonedds");
    EXPECT_EQ(run_->wait(patience), status) << run_->errors();
    return read_json(folder_ / "result.json");
  }

  // Magnitude and phase of every step lie within four standard uncertainties of the truth.
  void expect_covered(const nlohmann::json& result) const {
    const auto truth = read_json(folder_ / "truth.json");
    std::size_t compared = 0;
    for (const auto& expected : truth["transfer_function"]) {
      for (const auto& point : result["points"]) {
        if (point["frequency_hz"] != expected["frequency_hz"]) {
          continue;
        }
        ++compared;
        EXPECT_NEAR(point["magnitude"].get<double>(), expected["magnitude"].get<double>(),
                    4.0 * point["u_magnitude"].get<double>());
        const double phase = point["phase_rad"].get<double>() - expected["phase_rad"].get<double>();
        EXPECT_LE(std::abs(std::remainder(phase, 2.0 * std::numbers::pi)),
                  4.0 * point["u_phase_rad"].get<double>());
      }
    }
    EXPECT_EQ(compared, 2U);
  }

  static void expect_complete(const nlohmann::json& result) {
    ASSERT_FALSE(result.is_discarded());
    ASSERT_EQ(result["points"].size(), 2U);
    for (const auto& point : result["points"]) {
      EXPECT_TRUE(point["valid"].get<bool>()) << point;
      EXPECT_EQ(point["samples"]["tss"], 4 * 1000) << "all four shots: " << point;
      EXPECT_EQ(point["flags"], nlohmann::json::array()) << point;
    }
  }

  std::filesystem::path folder_;
  std::optional<ProgramRun> virtual_bench_;
  std::optional<Laboratory> laboratory_;
  ProgramRun* dso_ = nullptr;
  ProgramRun* run_ = nullptr;
};

TEST_F(SeriesFaults, ShotsSpoiledByABadLineAreRepeatedUntilTheStepHasAll) {
  start("line", {"--scope-fault", "garbage=0.01", "--scope-fault", "half-answer=0.005",
                 "--scope-fault", "other-answer=0.01", "--scope-fault", "wrong-length=0.05",
                 "--scope-fault", "disconnect=0.01", "--scope-pieces", "1500"});
  expect_complete(run());
  EXPECT_THAT(dso_->errors(), HasSubstr("oscilloscope 127.0.0.1:")); // clear lines about it
}

TEST_F(SeriesFaults, ASensorThatRunsFreeIsNoticedAndCorrected) {
  start("free", {"--fault", "free-running"});
  const auto result = run();
  ASSERT_FALSE(result.is_discarded());
  expect_covered(result);
  for (const auto& point : result["points"]) {
    EXPECT_THAT(point["series_start"].get<std::string>(),
                AnyOf(HasSubstr("uniform over one sample"), HasSubstr("undecided")));
    EXPECT_GT(point["series_start_scatter_s"].get<double>(), 20e-6);
    EXPECT_GT(point["u_phase_rad"].get<double>(), 0.01); // four shots of a start that is not known
  }
  EXPECT_EQ(result["points"][1]["series_start"], "uniform over one sample after the trigger");
}

TEST_F(SeriesFaults, AStartThatScattersIsCoveredByTheUncertainty) {
  start("jitter", {"--fault", "start-jitter=50e-6"});
  const auto result = run();
  ASSERT_FALSE(result.is_discarded());
  expect_covered(result);
  EXPECT_GT(result["points"][1]["u_phase_rad"].get<double>(), 0.01); // 160 Hz: 50 mrad a shot
}

TEST_F(SeriesFaults, ASensorAtItsEndStopsIsRefused) {
  start("over-range", {"--fault", "over-range=80,at=sensor"});
  const auto result = run(1);
  ASSERT_FALSE(result.is_discarded());
  ASSERT_EQ(result["points"].size(), 2U);
  for (const auto& point : result["points"]) {
    EXPECT_FALSE(point["valid"].get<bool>()) << point;
    EXPECT_THAT(point["problem"].get<std::string>(),
                HasSubstr("tss/acceleration_z is over its range"));
  }
  EXPECT_THAT(run_->output(), HasSubstr("tss/acceleration_z is over its range"));
}

TEST_F(SeriesFaults, SamplesThatASeriesLostAreSeen) {
  start("loss", {"--fault", "loss=0.01,at=sensor,counted=no"});
  const auto result = run();
  ASSERT_FALSE(result.is_discarded());
  ASSERT_EQ(result["points"].size(), 2U);
  for (const auto& point : result["points"]) {
    EXPECT_NE(point["flags"], nlohmann::json::array()) << point;
  }
}

} // namespace
} // namespace dyncal::tests
