// What a guard finds after a restart of what it has kept, and that damaged files are none.
#include "services/programs/guard/driven_record.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs {
namespace {

const DrivenRun driven{"r1", false, {{40.0, 0.8}, {80.0, std::nullopt}}, true};

TEST(DrivenRecord, GivesBackWhatWasWritten) {
  const tests::TemporaryFolder folder;
  const DrivenRecord record(folder.path() / "new" / "folder", "bench/1", "192.0.2.7:5025");
  EXPECT_EQ(record.read(), DrivenRun{});
  ASSERT_TRUE(record.write(driven));
  EXPECT_EQ(record.read(), driven);
  ASSERT_TRUE(record.write({}));
  EXPECT_EQ(record.read(), DrivenRun{});
  EXPECT_TRUE(record.write({})) << "that is gone already";
}

TEST(DrivenRecord, GivesBackTheConductorOfItsRun) {
  const tests::TemporaryFolder folder;
  const DrivenRecord record(folder.path(), "b", "g");
  EXPECT_EQ(record.read_conductor(), Conductor{});
  ASSERT_TRUE(record.write(driven));
  EXPECT_EQ(record.read_conductor(), Conductor{}) << "as a guard of 0.2.0 writes it";
  Conductor conductor{"r1", "0110aa"};
  for (const auto& link : {std::optional<NumberedLink>{}, std::optional(NumberedLink{7, {1, 2}})}) {
    conductor.links[1] = link;
    ASSERT_TRUE(record.write(driven, conductor));
    EXPECT_EQ(record.read_conductor(), conductor);
    EXPECT_EQ(record.read(), driven);
  }
  ASSERT_TRUE(record.write(driven, {"r2", "0110aa"}));
  EXPECT_EQ(record.read_conductor(), Conductor{});
}

TEST(DrivenRecord, IsOneFileForEachBenchAndOfOneGenerator) {
  const tests::TemporaryFolder folder;
  ASSERT_TRUE(DrivenRecord(folder.path(), "a b", "192.0.2.7:5025").write(driven));
  EXPECT_EQ(DrivenRecord(folder.path(), "a_b", "192.0.2.7:5025").read(), DrivenRun{});
  EXPECT_EQ(DrivenRecord(folder.path(), "a b", "192.0.2.8:5025").read(), DrivenRun{});
  EXPECT_EQ(DrivenRecord(folder.path(), "a b", "192.0.2.7:5025").read(), driven);
}

TEST(DrivenRecord, TakesDamagedFilesForNone) {
  const tests::TemporaryFolder folder;
  const DrivenRecord record(folder.path(), "b", "g");
  for (const char* text :
       {"", "{", "[]", "{}", R"({"generator": "g"})",
        R"({"generator": "g", "run": 5, "has_ended": false, "settings": []})",
        R"({"generator": "g", "run": "r", "has_ended": false, "settings": [{}]})"}) {
    folder.write("b.json", text);
    EXPECT_EQ(record.read(), DrivenRun{}) << text;
  }
}

TEST(DrivenRecord, SaysWhereItCannotBeWritten) {
  const tests::TemporaryFolder folder;
  folder.write("file", "");
  const auto written = DrivenRecord(folder.path() / "file", "b", "g").write(driven);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::bad_file);
}

} // namespace
} // namespace dyncal::inline programs
