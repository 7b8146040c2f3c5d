// Two benches at once on one network with one analysis service: each gets its own results, as if it
// were alone.
#include <csignal>

#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

TEST(TwoBenches, GetTheirOwnResultsUnchangedByEachOther) {
  const auto folder = fresh_folder("two-benches");
  std::filesystem::create_directories(folder / "a");
  std::filesystem::create_directories(folder / "b");
  const auto bench_a = recorded_bench(folder / "a", "bench-a", "5");
  const auto bench_b = recorded_bench(folder / "b", "bench-b", "6");

  Laboratory laboratory(folder);
  laboratory.start("dyncal-analysis", {}, "fastdds");
  laboratory.start("dyncal-acs", {bench_a}, "fastdds");
  laboratory.start("dyncal-acs", {bench_b}, "cyclonedds");
  const auto run = [&](const std::filesystem::path& bench,
                       const std::filesystem::path& json) -> ProgramRun& {
    return laboratory.start("dyncal", {"run", bench, "--output", json}, "fastdds");
  };
  ProgramRun& alone = run(bench_a, folder / "alone.json");
  ASSERT_EQ(alone.wait(patience), 0) << alone.errors();
  ProgramRun& a = run(bench_a, folder / "a.json");
  ProgramRun& b = run(bench_b, folder / "b.json");
  ASSERT_EQ(a.wait(patience), 0) << a.errors();
  ASSERT_EQ(b.wait(patience), 0) << b.errors();

  const auto alone_json = read_json(folder / "alone.json");
  const auto a_json = read_json(folder / "a.json");
  const auto b_json = read_json(folder / "b.json");
  EXPECT_EQ(a_json["points"], alone_json["points"]);
  EXPECT_EQ(b_json["bench"], "bench-b");
  ASSERT_EQ(b_json["points"].size(), a_json["points"].size());
  EXPECT_NE(b_json["points"], a_json["points"]);
}

// Its Monte Carlo checks take far longer than the run of the other bench.
TEST(TwoBenches, OneThatIsCostlyToEvaluateHoldsNobodyUp) {
  const auto folder = fresh_folder("costly-bench");
  std::filesystem::create_directories(folder / "a");
  std::filesystem::create_directories(folder / "b");
  const auto bench_a = recorded_bench(folder / "a", "bench-a", "5");
  const auto bench_b = recorded_bench(folder / "b", "bench-b", "6");
  std::ofstream(bench_b, std::ios::app) << "monte_carlo_trials = 100000000\n";
  ProgramRun alone("dyncal", {"analyse", bench_a, "--output", folder / "alone.json"}, folder);
  ASSERT_EQ(alone.wait(patience), 0) << alone.errors();

  Laboratory laboratory(folder);
  ProgramRun& analysis = laboratory.start("dyncal-analysis", {}, "cyclonedds");
  laboratory.start("dyncal-acs", {bench_a}, "cyclonedds");
  laboratory.start("dyncal-acs", {bench_b}, "cyclonedds");
  ProgramRun& b = laboratory.start("dyncal", {"run", bench_b}, "cyclonedds");
  ASSERT_TRUE(analysis.wait_for_error_text(": armed", patience)) << analysis.errors();
  ProgramRun& a =
      laboratory.start("dyncal", {"run", bench_a, "--output", folder / "a.json"}, "cyclonedds");
  ASSERT_EQ(a.wait(patience), 0) << a.errors();
  EXPECT_FALSE(b.wait(std::chrono::nanoseconds(0))) << "it was not costly: " << b.errors();
  const auto a_json = read_json(folder / "a.json");
  EXPECT_EQ(a_json["points"], read_json(folder / "alone.json")["points"]);
  EXPECT_FALSE(a_json.contains("pauses")) << a_json["pauses"];

  b.send(SIGKILL);
  analysis.send(SIGTERM);
  EXPECT_EQ(analysis.wait(std::chrono::seconds(20)), 0) << analysis.errors();
}

} // namespace
} // namespace dyncal::tests
