#include "services/bench/file/run_end_table.hpp"

#include <gmock/gmock.h>
#include <toml++/toml.h>

#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string problem_of(const std::string& text) {
  const auto parsed = parse_toml(text, "b.toml");
  BenchProblems problems;
  TomlTable root(*parsed, "", "b.toml", problems);
  static_cast<void>(read_run_end(root));
  return problems.empty() ? "" : problems.front().text();
}

TEST(RunEndTable, IsAProgramWithItsArguments) {
  const auto settings =
      run_end_settings_of("[run]\non_end = [\"tell\", \"a b; rm -rf /\"]\non_end_limit_s = 5\n");
  ASSERT_TRUE(settings);
  EXPECT_THAT(settings->command, ElementsAre("tell", "a b; rm -rf /"));
  EXPECT_EQ(settings->limit_s, 5.0);
  EXPECT_EQ(run_end_settings_of("[run]\non_end = [\"tell\"]\n")->limit_s, 30.0);
  EXPECT_FALSE(run_end_settings_of("bench = \"b\"\n"));
}

TEST(RunEndTable, RefusesWhatIsNotMeant) {
  EXPECT_THAT(problem_of("[run]\n"), HasSubstr("on_end"));
  EXPECT_THAT(problem_of("[run]\non_end = []\n"), HasSubstr("a program and its arguments"));
  EXPECT_THAT(problem_of("[run]\non_end = [\"\"]\n"), HasSubstr("a program and its arguments"));
  EXPECT_THAT(problem_of("[run]\non_end = [\"A=b\", \"c\"]\n"), HasSubstr("'='"));
  EXPECT_THAT(problem_of("[run]\non_end = \"mail me\"\n"), HasSubstr("on_end"));
  EXPECT_THAT(problem_of("[run]\non_end = [\"a\"]\non_end_limit_s = 0\n"),
              HasSubstr("on_end_limit_s"));
  EXPECT_THAT(problem_of("[run]\non_end = [\"a\"]\nat_end = 1\n"), HasSubstr("at_end"));
}

} // namespace
} // namespace dyncal::inline bench
