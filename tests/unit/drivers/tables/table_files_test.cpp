#include "drivers/tables/table_files.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/drivers/tables/table_examples.hpp"

namespace dyncal::drivers::tables {
namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(TableFiles, ReadsAFolderInTheOrderOfItsNames) {
  const tests::TemporaryFolder folder;
  write(folder.path() / "loop2.csv", spektra_csv_example);
  write(folder.path() / "loop1.csv", strict_example);
  write(folder.path() / ".lock", "no table");
  const auto files = read_table_files({.paths = {folder.path()}});
  ASSERT_TRUE(files.has_value()) << files.error().message;
  ASSERT_EQ(files->size(), 2U);
  EXPECT_EQ(files->front().name, (folder.path() / "loop1.csv").string());
  EXPECT_EQ(files->back().rows.size(), 2U);
}

TEST(TableFiles, SaysWhatIsNotThereUnlessItIsStillToCome) {
  const tests::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "t.csv";
  const auto missing = read_table_files({.paths = {file}});
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
  EXPECT_EQ(missing.error().message,
            file.string() + ": the table cannot be read: it is no file, or not there");
  const auto coming = read_table_files({.paths = {file}}, TableIs::written_to);
  ASSERT_TRUE(coming.has_value());
  EXPECT_TRUE(coming->empty());
  const auto empty = read_table_files({.paths = {folder.path()}});
  ASSERT_FALSE(empty.has_value());
  EXPECT_EQ(empty.error().message, folder.path().string() + ": the folder holds no table");
}

} // namespace
} // namespace dyncal::drivers::tables
