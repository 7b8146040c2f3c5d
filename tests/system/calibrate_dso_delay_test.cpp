// `dyncal calibrate dso-delay` at the virtual bench's oscilloscope, whose trigger output comes
// 236(1) ns after the trigger.
#include <chrono>
#include <cmath>
#include <csignal>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/instrument_question.hpp"
#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

class CalibrateDsoDelay : public testing::TestWithParam<const char*> {
protected:
  void start_bench(const std::vector<std::string>& options) {
    folder_ = fresh_folder(std::string("calibrate-dso-delay-") + GetParam() +
                           std::to_string(options.size()));
    std::vector<std::string> arguments{"--preset", "tss", "--ports-file", folder_ / "ports.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    bench_.emplace("dyncal-virtual-bench", arguments, folder_);
    ASSERT_TRUE(bench_->wait_for_error_text("ports", patience));
    const auto ports = read_json(folder_ / "ports.json");
    oscilloscope_ = "127.0.0.1:" + ports["dso"].dump();
    generator_port_ = ports["generator"].get<int>();
    generator_ = "127.0.0.1:" + std::to_string(generator_port_);
  }
  // "ON" or "OFF", as soon as it is so.
  [[nodiscard]] bool wait_for_output(const std::string& state) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (ask_instrument(generator_port_, ":OUTPut1?") == state) {
        return true;
      }
    }
    return false;
  }

  std::filesystem::path folder_;
  std::optional<ProgramRun> bench_;
  std::string oscilloscope_;
  std::string generator_;
  int generator_port_ = 0;
};

TEST_P(CalibrateDsoDelay, Finds236NanosecondsWithinItsStatedNanosecond) {
  start_bench({});
  const auto file = folder_ / "dso-delay.json";
  const auto work = fresh_folder(std::string("calibrate-dso-delay-run-") + GetParam());
  ProgramRun calibrate("dyncal",
                       {"calibrate", "dso-delay", "--oscilloscope", oscilloscope_, "--generator",
                        generator_, "--by", GetParam(), "--shots", "25", "--output", file},
                       work);
  ASSERT_EQ(calibrate.wait(patience), 0) << calibrate.errors();
  const auto json = read_json(file);
  EXPECT_NEAR(json["value_s"].get<double>(), 236e-9, 1e-9);
  EXPECT_GT(json["u_s"].get<double>(), 0.1e-9);
  EXPECT_LE(json["u_s"].get<double>(), 1e-9);
  EXPECT_NEAR(json["scatter_s"].get<double>(), 1e-9, 0.5e-9);
  EXPECT_EQ(json["shots"], 25);
  const auto counts = json["histogram"]["counts"].get<std::vector<int>>();
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0), 25);
  EXPECT_THAT(calibrate.output(), HasSubstr("dso_delay = { file = \"" + file.string() + "\" }"));
}

TEST_P(CalibrateDsoDelay, RepeatsShotsThatABadLineSpoils) {
  start_bench({"--scope-fault", "garbage=0.003", "--scope-fault", "other-answer=0.003"});
  const auto work = fresh_folder(std::string("calibrate-dso-delay-bad-") + GetParam());
  ProgramRun calibrate("dyncal",
                       {"calibrate", "dso-delay", "--oscilloscope", oscilloscope_, "--generator",
                        generator_, "--by", GetParam(), "--shots", "20", "--output",
                        work / "delay.json"},
                       work);
  ASSERT_EQ(calibrate.wait(patience), 0) << calibrate.errors();
  const auto json = read_json(work / "delay.json");
  EXPECT_GT(json["failed_shots"], 0);
  EXPECT_EQ(json["shots"], 20);
  EXPECT_NEAR(json["value_s"].get<double>(), 236e-9, 1.5e-9);
}

// A terminal that is closed, and a program that is killed: nobody is there who could see to the
// output but the process that guards it.
TEST_P(CalibrateDsoDelay, LeavesTheOutputOffHoweverItEnds) {
  start_bench({});
  for (const int signal : {SIGHUP, SIGKILL}) {
    const auto work =
        fresh_folder(std::string("calibrate-dso-delay-end-") + GetParam() + std::to_string(signal));
    ProgramRun calibrate("dyncal",
                         {"calibrate", "dso-delay", "--oscilloscope", oscilloscope_, "--generator",
                          generator_, "--by", GetParam(), "--shots", "100000", "--output",
                          work / "delay.json"},
                         work);
    ASSERT_TRUE(wait_for_output("ON")) << calibrate.errors();
    calibrate.send(signal);
    ASSERT_TRUE(calibrate.wait(patience));
    EXPECT_TRUE(wait_for_output("OFF")) << "after signal " << signal;
  }
}

INSTANTIATE_TEST_SUITE_P(ByBothWays, CalibrateDsoDelay, testing::Values("rectangle", "sine"),
                         [](const auto& way) { return std::string(way.param); });

} // namespace
} // namespace dyncal::tests
