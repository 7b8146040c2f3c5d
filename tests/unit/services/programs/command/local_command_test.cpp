#include "services/programs/command/local_command.hpp"

#include <filesystem>

#include <gmock/gmock.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs {
namespace {

using testing::HasSubstr;

constexpr std::chrono::seconds patience{20};

TEST(LocalCommand, GivesWhatTheProgramPrints) {
  const auto output =
      run_local_command({.words = {"sh", "-c", "echo \"$DYNCAL_RUN, $1\"", "sh", "a b"},
                         .environment = {{"DYNCAL_RUN", "first; $(touch x)"}},
                         .limit = patience});
  ASSERT_TRUE(output) << output.error().message;
  EXPECT_EQ(*output, "first; $(touch x), a b\n");
}

// No shell sees a word.
TEST(LocalCommand, TakesNoTextForACommand) {
  const tests::TemporaryFolder folder;
  const std::string file = (folder.path() / "made").string();
  const auto output = run_local_command(
      {.words = {"echo", "$(touch " + file + ")", "; touch " + file, "`touch " + file + "`"},
       .limit = patience});
  ASSERT_TRUE(output) << output.error().message;
  EXPECT_THAT(*output, HasSubstr("$(touch "));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(LocalCommand, SaysHowItFailed) {
  const auto failed =
      run_local_command({.words = {"sh", "-c", "echo no printer >&2; exit 3"}, .limit = patience});
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("ended with status 3 (no printer)"));
  EXPECT_FALSE(run_local_command({.words = {"/nowhere/at/all"}, .limit = patience}));
}

TEST(LocalCommand, IsEndedAtItsLimit) {
  const auto begun = std::chrono::steady_clock::now();
  const auto late =
      run_local_command({.words = {"tail", "-f", "/dev/null"}, .limit = std::chrono::seconds(1)});
  ASSERT_FALSE(late);
  EXPECT_THAT(late.error().message, HasSubstr("had not ended after 1 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - begun, patience);
}

} // namespace
} // namespace dyncal::inline programs
