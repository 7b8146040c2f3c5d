// Two benches at once on one network with one analysis service: each gets its own results, as if it
// were alone.
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
    return laboratory.start("dyncal", {"run", bench, "--json", json}, "fastdds");
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

} // namespace
} // namespace dyncal::tests
