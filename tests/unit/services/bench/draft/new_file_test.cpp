#include "services/bench/draft/new_file.hpp"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench::bench_draft {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(NewFile, IsWrittenWhole) {
  const tests::TemporaryFolder folder;
  ASSERT_TRUE(write_new_file(folder.path() / "bench.toml", "text\n").has_value());
  EXPECT_EQ(text_of(folder.path() / "bench.toml"), "text\n");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(NewFile, NeverTakesThePlaceOfAnother) {
  const tests::TemporaryFolder folder;
  const std::filesystem::path path = folder.write("bench.toml", "mine\n");
  const auto written = write_new_file(path, "other\n");
  ASSERT_FALSE(written.has_value());
  EXPECT_THAT(written.error().message, testing::HasSubstr("there is such a file already"));
  EXPECT_EQ(text_of(path), "mine\n");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(NewFile, ANameIsFreeOnlyWhereOneCouldBeWritten) {
  const tests::TemporaryFolder folder;
  EXPECT_TRUE(check_new_file(folder.path() / "bench.toml").has_value());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 0);
  std::filesystem::create_symlink("gone.toml", folder.path() / "link.toml");
  EXPECT_FALSE(check_new_file(folder.path() / "link.toml").has_value());
  EXPECT_FALSE(check_new_file(folder.path() / "gone" / "bench.toml").has_value());
}

TEST(NewFile, FolderThatIsNotThere) {
  const tests::TemporaryFolder folder;
  EXPECT_FALSE(write_new_file(folder.path() / "gone" / "bench.toml", "text\n").has_value());
}

} // namespace
} // namespace dyncal::inline bench::bench_draft
