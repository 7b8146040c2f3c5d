// What disturbs a run for a while is waited out: it goes on, repeats what was spoilt, and ends with
// every result, unflagged.
#include <csignal>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

class DisturbedRun : public testing::Test {
protected:
  // Steps that last longer than it takes to notice that the analysis is silent.
  void start(const std::string& name, const std::vector<std::string>& options = {}) {
    folder_ = fresh_folder("disturbed-" + name);
    bench_ = std::make_unique<LiveBench>(
        folder_,
        LiveBenchSettings{.bench_arguments = {"--frequencies", "40,80,125", "--levels", "20"},
                          .excitation = "frequencies_hz = [\"40\", \"80\", \"125\"]\nlevel = 20.0\n"
                                        "settling_s = 0.5\nduration_s = 5\n",
                          .rest = "adc_delay_s = 1e-6\n"});
    std::vector<std::string> arguments{"run", bench_->bench_file(), "--output",
                                       folder_ / "result.json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    run_ = &bench_->start(arguments);
    ASSERT_TRUE(run_->wait_for_error_text("step 2 of 3", patience)) << run_->errors();
  }
  void expect_complete() {
    const auto result = expect_every_result();
    EXPECT_GE(repeated_, 3) << run_->errors(); // of the step that was broken off
    EXPECT_FALSE(result["pauses"].empty());
  }
  [[nodiscard]] double true_magnitude(const nlohmann::json& point) const {
    const auto truth = bench_->truth();
    for (const auto& expected : truth["transfer_function"]) {
      if ("dau/" + expected["channel"].get<std::string>() == point["channel"].get<std::string>() &&
          expected["frequency_hz"] == point["frequency_hz"]) {
        return expected["magnitude"].get<double>();
      }
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  nlohmann::json expect_every_result() {
    const auto status = run_->wait(patience);
    EXPECT_EQ(status.value_or(-1), 0) << run_->errors();
    auto result = read_json(folder_ / "result.json");
    EXPECT_EQ(result["points"].size(), 9U) << run_->errors();
    for (const auto& point : result["points"]) {
      EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
      EXPECT_EQ(point["flags"].size(), 0U) << point["flags"];
      repeated_ += point.contains("attempt") ? 1 : 0;
    }
    EXPECT_EQ(bench_->ask_generator(":OUTPut1?"), "OFF");
    return result;
  }

  std::filesystem::path folder_;
  std::unique_ptr<LiveBench> bench_;
  ProgramRun* run_ = nullptr;
  int repeated_ = 0; // results
};

TEST_F(DisturbedRun, AnAnalysisThatHangsForAWhile) {
  start("analysis-hangs");
  bench_->service("dyncal-analysis").send(SIGSTOP);
  ASSERT_TRUE(run_->wait_for_error_text("waiting for it or another up to 120 s (the output is off)",
                                        patience))
      << run_->errors();
  EXPECT_EQ(bench_->ask_generator(":OUTPut1?"), "OFF");
  bench_->service("dyncal-analysis").send(SIGCONT);
  expect_complete();
}

TEST_F(DisturbedRun, AnAnalysisThatIsRestarted) {
  start("analysis-restarted");
  bench_->service("dyncal-analysis").send(SIGKILL);
  ASSERT_TRUE(run_->wait_for_error_text("waiting for it or another", patience)) << run_->errors();
  bench_->start_service("dyncal-analysis");
  expect_complete();
}

TEST_F(DisturbedRun, ASourceThatIsRestarted) {
  start("source-restarted");
  bench_->service("dyncal-dau").send(SIGKILL);
  ASSERT_TRUE(run_->wait_for_error_text("waiting for it up to 120 s", patience)) << run_->errors();
  bench_->start_service("dyncal-dau");
  expect_complete();
}

// Somebody edits the bench file, and the service dies and comes back with what it says now: two
// axes have changed places. Nothing of it becomes a value.
TEST_F(DisturbedRun, ASourceThatIsRestartedWithAnotherBenchFile) {
  start("source-restarted-otherwise");
  bench_->service("dyncal-dau").send(SIGKILL);
  ASSERT_TRUE(run_->wait_for_error_text("waiting for it up to 120 s", patience)) << run_->errors();
  ProgramRun& swapped = bench_->start_service(
      "dyncal-dau",
      bench_->changed_bench_file("swapped.toml", "channels =",
                                 "channels = { Data_11 = \"sync\", Data_02 = \"acceleration_z\", "
                                 "Data_03 = \"acceleration_y\" }"));
  ASSERT_TRUE(run_->wait_for_error_text("has read another bench file than this run: key "
                                        "'sources.dau.channels.",
                                        patience))
      << run_->errors() << swapped.errors();
  EXPECT_EQ(bench_->ask_generator(":OUTPut1?"), "OFF");
  swapped.send(SIGTERM);
  ASSERT_TRUE(swapped.wait(patience));
  bench_->start_service("dyncal-dau");
  const auto result = expect_every_result();
  EXPECT_THAT(result["pauses"].dump(), HasSubstr("has read another bench file than this run"));
  for (const auto& point : result["points"]) {
    const double magnitude = true_magnitude(point);
    EXPECT_NEAR(point["magnitude"].get<double>(), magnitude, 0.1 * magnitude) << point;
  }
}

// The bench stands still, as when its link is down: generator and sources do not answer.
TEST_F(DisturbedRun, ABenchWhoseLinkIsDown) {
  start("link-down");
  bench_->signal_bench(SIGSTOP);
  ASSERT_TRUE(run_->wait_for_error_text("waiting for it", patience)) << run_->errors();
  bench_->signal_bench(SIGCONT);
  expect_complete();
}

TEST_F(DisturbedRun, ARunWhoseProgramWasKilledIsResumed) {
  start("resumed", {"--run", "r7"});
  run_->send(SIGKILL);
  ASSERT_TRUE(run_->wait(patience));
  run_ = &bench_->start(
      {"run", bench_->bench_file(), "--resume", "r7", "--output", folder_ / "result.json"});
  ASSERT_TRUE(run_->wait_for_error_text("run 'r7' is resumed, with ", patience)) << run_->errors();
  expect_every_result();
}

TEST_F(DisturbedRun, AnotherRunWaitsForItsTurn) {
  start("waits");
  ProgramRun& second = bench_->start({"run", bench_->bench_file(), "--wait", "--run", "second"});
  ASSERT_TRUE(second.wait_for_error_text("waiting for the end of run '", patience))
      << second.errors();
  ASSERT_EQ(run_->wait(patience), 0) << run_->errors();
  EXPECT_EQ(second.wait(patience), 0) << second.errors();
  EXPECT_THAT(second.output(), HasSubstr("run second"));
}

} // namespace
} // namespace dyncal::tests
