#include "services/views/report/run_statements.hpp"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "services/views/report/result_json.hpp"
#include "services/views/report/stored_result.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

RunStatements example() {
  return {.check = {},
          .conducted_by = ActingPerson{"A. Meter", "meter", "lab3"},
          .comment = "second mounting",
          .conditions = {{.quantity = "temperature",
                          .unit = "degC",
                          .source = "file room.csv",
                          .count = 3,
                          .minimum = 22.9,
                          .mean = 23.1,
                          .maximum = 23.4,
                          .expanded = 0.3,
                          .problem = {}}}};
}

TEST(RunStatements, StandInTheResultFile) {
  const tests::TemporaryFolder folder;
  const auto file = folder.path() / "result.json";
  std::ofstream(file) << result_json(tests::example_outcome());
  const auto without = read_result(file);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_FALSE(without->conducted_by);
  EXPECT_THAT(without->conditions, IsEmpty());
  std::ofstream(file) << result_json(tests::example_outcome(), example());
  const auto with = read_result(file); // by its schema
  ASSERT_TRUE(with) << with.error().message;
  EXPECT_EQ(with->content_sha256, without->content_sha256); // no evaluation gives them
  EXPECT_NE(with->sha256, without->sha256);
  EXPECT_EQ(with->conducted_by, example().conducted_by);
  EXPECT_EQ(with->comment, "second mounting");
  ASSERT_THAT(with->conditions, SizeIs(1));
  EXPECT_EQ(with->conditions[0].count, 3U);
  EXPECT_EQ(with->conditions[0].mean, 23.1);
}

TEST(RunStatements, AreRefusedWhereAMemberIsMissing) {
  const tests::TemporaryFolder folder;
  const auto file = folder.path() / "result.json";
  for (const char* member : {"conducted_by", "conditions"}) {
    nlohmann::ordered_json json = result_json(tests::example_outcome(), example());
    nlohmann::ordered_json& one = json[member].is_array() ? json[member][0] : json[member];
    one.erase(one.begin());
    std::ofstream(file) << json;
    const auto refused = read_result(file);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr(member));
  }
}

TEST(RunStatements, KnowReadingsThatAreMissing) {
  const tests::TemporaryFolder folder;
  const auto file = folder.path() / "result.json";
  RunStatements stated = example();
  stated.conditions[0].count = 0;
  stated.conditions[0].mean = std::nan("");
  stated.conditions[0].problem = "no such file";
  std::ofstream(file) << result_json(tests::example_outcome(), stated);
  const auto read = read_result(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(std::isnan(read->conditions.at(0).mean));
  EXPECT_EQ(read->conditions[0].problem, "no such file");
}

TEST(LoggedCondition, CoversAReadingAndHowFarItWent) {
  LoggedCondition steady = example().conditions[0];
  steady.minimum = steady.maximum = steady.mean;
  EXPECT_EQ(steady.expanded_over_run(), 0.3);
  const LoggedCondition moving = example().conditions[0];
  const double u_of_range = 0.25 / std::sqrt(3.0);
  EXPECT_NEAR(moving.expanded_over_run(), 2.0 * std::hypot(0.15, u_of_range), 1e-12);
}

} // namespace
} // namespace dyncal::inline views
