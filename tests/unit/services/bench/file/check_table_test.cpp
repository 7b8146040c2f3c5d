#include "services/bench/file/check_table.hpp"

#include <array>

#include <gmock/gmock.h>
#include <toml++/toml.h>

#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline bench {
namespace {

using ::testing::HasSubstr;

std::string problem_of(const std::string& text) {
  const auto parsed = parse_toml(text, "b.toml");
  BenchProblems problems;
  TomlTable root(*parsed, "", "b.toml", problems);
  static_cast<void>(read_check(root));
  return problems.empty() ? "" : problems.front().text();
}

TEST(CheckTable, IsReadFromTheTextOfABenchFile) {
  const std::string text = "bench = \"b\"\n[check]\nsensor = \"SN-4711\"\nmax_age_h = 12\n";
  const auto check = check_settings_of(text);
  ASSERT_TRUE(check);
  EXPECT_EQ(check->sensor, "SN-4711");
  EXPECT_EQ(check->max_age_h, 12.0);
  EXPECT_EQ(check->first, 10);
  EXPECT_FALSE(check->limit_percent);
  const auto limits = check_settings_of(text + "first = 5\nlimit_percent = 0.2\nlimit_deg = 0.5\n");
  ASSERT_TRUE(limits);
  EXPECT_EQ(limits->first, 5);
  EXPECT_EQ(limits->limit_percent, 0.2);
  EXPECT_EQ(limits->limit_deg, 0.5);
  EXPECT_FALSE(check_settings_of("bench = \"b\"\n# [check]\n"));
  EXPECT_FALSE(check_settings_of("this is no TOML"));
}

TEST(CheckTable, RefusesWhatIsNotMeant) {
  const std::string whole = "[check]\nsensor = \"x\"\nmax_age_h = 24\n";
  EXPECT_EQ(problem_of(whole), "");
  const std::array<std::pair<std::string, std::string>, 6> cases{
      {{"[check]\nmax_age_h = 24\n", "'check.sensor' is missing"},
       {"[check]\nsensor = \"x\"\n", "'check.max_age_h' is missing"},
       {"[check]\nsensor = \"x\"\nmax_age_h = 0\n", "'check.max_age_h' must be above 0"},
       {whole + "first = 2\n", "3 or more"},
       {whole + "limit_percent = -1\n", "'check.limit_percent' must be above 0"},
       {whole + "limits = 1\n", "is not known"}}};
  for (const auto& [text, said] : cases) {
    EXPECT_THAT(problem_of(text), HasSubstr(said)) << text;
  }
}

} // namespace
} // namespace dyncal::inline bench
