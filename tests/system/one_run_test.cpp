// One bench, one run: a second run is refused while the first lives, and gets the bench of one that
// was killed, whose results hold nothing of what the second excites.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::AllOf;
using testing::HasSubstr;

LiveBenchSettings three_steps() {
  LiveBenchSettings settings;
  settings.bench_arguments = {"--frequencies", "40,80,125", "--levels", "20"};
  settings.excitation = "frequencies_hz = [\"40\", \"80\", \"125\"]\nlevel = 20.0\n"
                        "settling_s = 0.5\nduration_s = 1.5\n";
  settings.rest = "adc_delay_s = 1e-6\n";
  return settings;
}

TEST(OneRun, ASecondRunIsRefusedAndDoesNotTouchTheFirst) {
  const auto folder = fresh_folder("second_run");
  LiveBench bench(folder, three_steps());
  ProgramRun& first =
      bench.start({"run", bench.bench_file(), "--run", "first", "--json", folder / "first.json"});
  ASSERT_TRUE(first.wait_for_error_text("step 1 of 3", patience)) << first.errors();
  ProgramRun& second = bench.start({"run", bench.bench_file(), "--run", "second"});
  const auto refused = second.wait(patience);
  ASSERT_TRUE(refused);
  EXPECT_NE(*refused, 0);
  EXPECT_THAT(second.errors(), AllOf(HasSubstr("bench 'live' is in use by run 'first' of "),
                                     HasSubstr("; wait for its end, or end it there")));
  const auto status = first.wait(patience);
  ASSERT_TRUE(status);
  EXPECT_EQ(*status, 0) << first.errors();
  const auto result = read_json(folder / "first.json");
  ASSERT_EQ(result["points"].size(), 9U);
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    EXPECT_EQ(point["flags"].size(), 0U) << point["flags"];
  }
}

TEST(OneRun, TheNextRunGetsTheBenchOfOneThatWasKilled) {
  const auto folder = fresh_folder("killed_run");
  LiveBench bench(folder, three_steps());
  ProgramRun& killed = bench.start({"run", bench.bench_file(), "--run", "killed"});
  ASSERT_TRUE(killed.wait_for_error_text("step 2 of 3", patience)) << killed.errors();
  killed.send(SIGKILL);
  ProgramRun& watch = bench.start({"watch"});
  ProgramRun& next =
      bench.start({"run", bench.bench_file(), "--run", "next", "--json", folder / "next.json"});
  const auto status = next.wait(patience);
  ASSERT_TRUE(status);
  EXPECT_EQ(*status, 0) << next.errors();
  const auto result = read_json(folder / "next.json");
  ASSERT_EQ(result["points"].size(), 9U);
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    EXPECT_EQ(point["flags"].size(), 0U) << point["flags"];
  }
  EXPECT_TRUE(watch.wait_for_output_text("its bench was given to run 'next'", patience))
      << watch.output();
  watch.send(SIGTERM);
}

} // namespace
} // namespace dyncal::tests
