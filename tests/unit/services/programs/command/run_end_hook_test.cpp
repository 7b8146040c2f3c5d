#include "services/programs/command/run_end_hook.hpp"

#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs {
namespace {

using testing::HasSubstr;

RunOutcome outcome(const std::string& run) {
  RunOutcome ended;
  ended.bench = "acc-1";
  ended.run = run;
  return ended;
}

std::string text_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(RunEndHook, TellsTheRunAndItsState) {
  const tests::TemporaryFolder folder;
  const auto file = folder.path() / "told";
  const std::string bench = fmt::format(
      "[run]\non_end = [\"sh\", \"-c\", 'echo \"$DYNCAL_RUN|$DYNCAL_BENCH|$DYNCAL_STATE|"
      "$DYNCAL_FOLDER\" > \"$0\"', \"{}\"]\n",
      file.string());
  ASSERT_TRUE(run_end_hook(bench, outcome("first"), "/runs/acc-1/first"));
  EXPECT_EQ(text_of_file(file), "first|acc-1|complete|/runs/acc-1/first\n");
  RunOutcome stopped = outcome("$(touch x); `id`");
  stopped.interrupted = true;
  ASSERT_TRUE(run_end_hook(bench, stopped, ""));
  EXPECT_EQ(text_of_file(file), "$(touch x); `id`|acc-1|interrupted|\n");
  RunOutcome ended = outcome("first");
  ended.problem = "a source is away";
  ASSERT_TRUE(run_end_hook(bench, ended, ""));
  EXPECT_THAT(text_of_file(file), HasSubstr("|ended-early|"));
  RunOutcome lacking = outcome("first");
  lacking.planned_steps = 2;
  ASSERT_TRUE(run_end_hook(bench, lacking, ""));
  EXPECT_THAT(text_of_file(file), HasSubstr("|incomplete|"));
}

TEST(RunEndHook, SaysWhatBecameOfIt) {
  EXPECT_TRUE(run_end_hook("bench = \"acc-1\"\n", outcome("first"), ""));
  const auto failed = run_end_hook("[run]\non_end = [\"false\"]\n", outcome("first"), "");
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("false: ended with status 1"));
}

} // namespace
} // namespace dyncal::inline programs
