#include "services/views/report/daily_check.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "services/views/report/result_json.hpp"
#include "services/views/report/stored_result.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;

const DailyCheck example{.sensor = "SN-1",
                         .run = "monday",
                         .began_utc = "2026-11-23T07:00:00.000000000Z",
                         .state = "in control",
                         .left_out = {}};

TEST(DailyCheck, StandsInTheResultFile) {
  const tests::TemporaryFolder folder;
  const auto file = folder.path() / "result.json";
  std::ofstream(file) << result_json(tests::example_outcome());
  const auto without = read_result(file);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_FALSE(without->check);
  nlohmann::ordered_json json = result_json(tests::example_outcome(), {.check = example});
  std::ofstream(file) << json;
  const auto with = read_result(file); // by its schema
  ASSERT_TRUE(with) << with.error().message;
  EXPECT_EQ(with->content_sha256, without->content_sha256);
  ASSERT_TRUE(with->check);
  EXPECT_EQ(sentence_of(*with->check), "Daily check of the bench with sensor SN-1, run monday of "
                                       "2026-11-23T07:00:00.000000000Z: in control");
  json["check"].erase("left_out");
  std::ofstream(file) << json;
  const auto changed = read_result(file);
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().message, HasSubstr("check"));
}

TEST(DailyCheck, SaysWhyThereWasNone) {
  DailyCheck check = example;
  check.left_out = "the sensor is away";
  EXPECT_THAT(sentence_of(check), HasSubstr("SN-1 was left out: the sensor is away"));
  DailyCheck of_itself;
  of_itself.sensor = "SN-1";
  EXPECT_THAT(sentence_of(of_itself), HasSubstr("This run is of the check sensor"));
}

} // namespace
} // namespace dyncal::inline views
