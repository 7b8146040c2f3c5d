// A service that dies in the middle of a run and is started again, as systemd does: the run waits,
// loses nothing that can be had, repeats what cannot, and ends as an undisturbed one.
#include <algorithm>
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/evaluated_again.hpp"
#include "tests/system/live_bench.hpp"
#include "tests/system/test_folder.hpp"

namespace dyncal::tests {
namespace {

constexpr const char* in_the_middle = "step 2 of 3";
constexpr auto npos = std::string::npos;

LiveBenchSettings three_steps(const std::string& dds) {
  LiveBenchSettings settings;
  settings.bench_arguments = {"--frequencies", "40,80,125", "--levels", "20"};
  settings.excitation = "frequencies_hz = [\"40\", \"80\", \"125\"]\nlevel = 20.0\n"
                        "settling_s = 0.5\nduration_s = 1.5\n";
  settings.rest = "adc_delay_s = 1e-6\n";
  settings.dds = dds;
  return settings;
}

struct Restart {
  std::string program;
  std::string dds;
};

std::string name_of(const testing::TestParamInfo<Restart>& one) {
  return one.param.program.substr(std::string("dyncal-").size()) + "_" + one.param.dds;
}

class RestartedService : public testing::TestWithParam<Restart> {};

TEST_P(RestartedService, IsWaitedForAndTheRunIsWhole) {
  const auto [program, dds] = GetParam();
  const auto folder = fresh_folder("restarted-" + program + "-" + dds);
  LiveBench bench(folder, three_steps(dds));
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--output", folder / "run.json"});
  ASSERT_TRUE(run.wait_for_error_text(in_the_middle, patience)) << run.errors();
  bench.service(program).send(SIGKILL);
  bench.start_service(program);
  const auto status = run.wait(patience);
  ASSERT_TRUE(status) << run.errors();
  EXPECT_EQ(*status, 0) << run.errors();
  const auto result = read_json(folder / "run.json");
  ASSERT_EQ(result["points"].size(), 9U);
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    EXPECT_EQ(point["lost"].get<int>(), 0);
    EXPECT_EQ(point["flags"].size(), 0U) << point["flags"];
  }
  EXPECT_EQ(points_evaluated_again(folder), result["points"]);
  EXPECT_TRUE(bench.wait_for_output("OFF"));
}

INSTANTIATE_TEST_SUITE_P(
    EachServiceAndVendor, RestartedService,
    testing::Values(Restart{"dyncal-analysis", "fastdds"}, Restart{"dyncal-dau", "fastdds"},
                    Restart{"dyncal-acs", "fastdds"}, Restart{"dyncal-analysis", "cyclonedds"},
                    Restart{"dyncal-dau", "cyclonedds"}, Restart{"dyncal-acs", "cyclonedds"}),
    name_of);

// Recorded files are played: the results are those of an undisturbed run to the last bit.
class LostAnalysis : public testing::TestWithParam<std::string> {
protected:
  std::filesystem::path folder_ = fresh_folder_of_this_test();
  std::filesystem::path bench_ = played_at_twice_the_speed(recorded_bench(folder_, "files", "3"));
  Laboratory laboratory_{folder_};

  static std::filesystem::path played_at_twice_the_speed(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::filesystem::path played = file.parent_path() / "played.toml";
    std::ofstream out(played);
    for (std::string line; std::getline(in, line);) {
      out << line << '\n' << (line.starts_with("driver = ") ? "play = 2.0\n" : "");
    }
    return played;
  }
  ProgramRun& start(const std::string& program, const std::vector<std::string>& arguments) {
    return laboratory_.start(program, arguments, GetParam());
  }
  // When there are results of all three frequencies.
  static bool wait_for_first_repetition(ProgramRun& watch) {
    return watch.wait_for_output_text("160 Hz", patience);
  }
  void expect_bits_of_an_undisturbed_run() const {
    ProgramRun analyse("dyncal", {"analyse", bench_, "--output", folder_ / "analyse.json"},
                       folder_);
    EXPECT_EQ(analyse.wait(patience), 0) << analyse.errors();
    const auto expected = read_json(folder_ / "analyse.json");
    const auto result = read_json(folder_ / "run.json");
    ASSERT_EQ(expected["points"].size(), 18U);
    EXPECT_EQ(result["points"], expected["points"]);
    EXPECT_EQ(result["transfer_function"], expected["transfer_function"]);
  }
};

INSTANTIATE_TEST_SUITE_P(EachVendor, LostAnalysis, testing::Values("fastdds", "cyclonedds"),
                         [](const auto& vendor) { return vendor.param; });

TEST_P(LostAnalysis, RestartedGivesTheSameBits) {
  ProgramRun& analysis = start("dyncal-analysis", {});
  start("dyncal-acs", {bench_});
  ProgramRun& watch = start("dyncal", {"watch"});
  ProgramRun& run = start("dyncal", {"run", bench_, "--output", folder_ / "run.json"});
  ASSERT_TRUE(wait_for_first_repetition(watch)) << watch.output();
  analysis.send(SIGKILL);
  start("dyncal-analysis", {});
  const auto status = run.wait(patience);
  ASSERT_TRUE(status) << run.errors();
  EXPECT_EQ(*status, 0) << run.errors();
  expect_bits_of_an_undisturbed_run();
}

TEST_P(LostAnalysis, AnotherOneTakesOverWithTheSameBits) {
  ProgramRun& leader = start("dyncal-analysis", {});
  start("dyncal-acs", {bench_});
  ProgramRun& watch = start("dyncal", {"watch"});
  ProgramRun& run = start("dyncal", {"run", bench_, "--output", folder_ / "run.json"});
  ASSERT_TRUE(wait_for_first_repetition(watch)) << watch.output();
  ProgramRun& other = start("dyncal-analysis", {});
  leader.send(SIGKILL);
  const auto status = run.wait(patience);
  ASSERT_TRUE(status) << run.errors();
  EXPECT_EQ(*status, 0) << run.errors();
  EXPECT_TRUE(other.wait_for_error_text("taken over", patience)) << other.errors();
  expect_bits_of_an_undisturbed_run();
}

// Both hear of the run when it is planned: one leads it, and its death is all that the other has
// waited for.
TEST_P(LostAnalysis, OneThatStoodByFromTheBeginningTakesOverWithTheSameBits) {
  std::vector<ProgramRun*> analyses{&start("dyncal-analysis", {}), &start("dyncal-analysis", {})};
  start("dyncal-acs", {bench_});
  ProgramRun& watch = start("dyncal", {"watch"});
  ProgramRun& run = start("dyncal", {"run", bench_, "--output", folder_ / "run.json"});
  ASSERT_TRUE(wait_for_first_repetition(watch)) << watch.output();
  const auto leads = [](ProgramRun* one) { // both may have armed before they heard of each other
    const std::string log = one->errors();
    return log.find(": armed") != npos && log.find("this service stands by") == npos;
  };
  ASSERT_EQ(std::ranges::count_if(analyses, leads), 1);
  std::partition(analyses.begin(), analyses.end(), leads);
  analyses[0]->send(SIGKILL);
  const auto status = run.wait(patience);
  ASSERT_TRUE(status) << run.errors();
  EXPECT_EQ(*status, 0) << run.errors();
  EXPECT_TRUE(analyses[1]->wait_for_error_text("taken over", patience)) << analyses[1]->errors();
  expect_bits_of_an_undisturbed_run();
}

TEST_P(LostAnalysis, StoppedForAWhileItGivesTheSameBits) {
  ProgramRun& analysis = start("dyncal-analysis", {});
  start("dyncal-acs", {bench_});
  ProgramRun& watch = start("dyncal", {"watch"});
  ProgramRun& run = start("dyncal", {"run", bench_, "--output", folder_ / "run.json"});
  ASSERT_TRUE(wait_for_first_repetition(watch)) << watch.output();
  analysis.send(SIGSTOP);
  EXPECT_FALSE(run.wait(std::chrono::seconds(8))) << run.errors(); // longer than every lease
  analysis.send(SIGCONT);
  const auto status = run.wait(patience);
  ASSERT_TRUE(status) << run.errors();
  EXPECT_EQ(*status, 0) << run.errors();
  expect_bits_of_an_undisturbed_run();
}

// A source that plays files has the rest of them to send when its run is gone.
class InterruptedRun : public LostAnalysis {};

INSTANTIATE_TEST_SUITE_P(EachVendor, InterruptedRun, testing::Values("fastdds", "cyclonedds"),
                         [](const auto& vendor) { return vendor.param; });

TEST_P(InterruptedRun, LeavesNothingToTheNextOne) {
  start("dyncal-analysis", {});
  start("dyncal-acs", {bench_});
  ProgramRun& watch = start("dyncal", {"watch"});
  ProgramRun& first = start("dyncal", {"run", bench_});
  ASSERT_TRUE(wait_for_first_repetition(watch)) << watch.output();
  first.send(SIGINT);
  ASSERT_TRUE(first.wait(patience)) << first.errors();
  ProgramRun& run = start("dyncal", {"run", bench_, "--output", folder_ / "run.json"});
  const auto status = run.wait(patience);
  ASSERT_TRUE(status) << run.errors();
  EXPECT_EQ(*status, 0) << run.errors();
  expect_bits_of_an_undisturbed_run();
}

} // namespace
} // namespace dyncal::tests
