#include "services/base/output_file.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline base {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFile : public testing::Test {
protected:
  static std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  const tests::TemporaryFolder own_;
  const fs::path& folder_ = own_.path();
  const fs::path path_ = folder_ / "result.json";
};

TEST_F(OutputFile, HasTheWholeTextAndLeavesNothingBeside) {
  const std::string text(3'000'000, 'x');
  ASSERT_TRUE(write_output_file(path_, text));
  EXPECT_EQ(text_of(path_), text);
  ASSERT_TRUE(write_output_file(path_, "shorter"));
  EXPECT_EQ(text_of(path_), "shorter");
  EXPECT_EQ(files(), 1U);
}

// A limit on the size of files stands for a full disk: write() fails in the middle of the text.
TEST_F(OutputFile, KeepsAnOlderFileWhenThereIsNoRoom) {
  ASSERT_TRUE(write_output_file(path_, "the certificate of last year"));
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  const rlimit little{4096, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &little);
  const auto written = write_output_file(path_, std::string(100'000, 'x'));
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::bad_file);
  EXPECT_THAT(written.error().message,
              HasSubstr("result.json: cannot be written (File too large)"));
  EXPECT_EQ(text_of(path_), "the certificate of last year");
  EXPECT_EQ(files(), 1U);
}

TEST_F(OutputFile, NamesFileAndReasonWhenItCannotBegin) {
  const auto written = write_output_file(folder_ / "missing" / "r.json", "text");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message,
              HasSubstr("missing/r.json: cannot be written (No such file or directory)"));
  const auto folder = write_output_file(folder_, "text");
  ASSERT_FALSE(folder);
  EXPECT_THAT(folder.error().message, HasSubstr("Is a directory"));
}

TEST_F(OutputFile, WritesIntoWhatIsNoRegularFile) {
  EXPECT_TRUE(write_output_file("/dev/null", "text"));
  EXPECT_TRUE(check_output_file("/dev/null"));
}

TEST_F(OutputFile, IsAskedForBeforeARunWithoutTouchingAnOlderFile) {
  EXPECT_TRUE(check_output_file(path_));
  EXPECT_EQ(files(), 0U);
  ASSERT_TRUE(write_output_file(path_, "older"));
  EXPECT_TRUE(check_output_file(path_));
  EXPECT_EQ(text_of(path_), "older");
  EXPECT_EQ(files(), 1U);
  EXPECT_FALSE(check_output_file(folder_));
  EXPECT_FALSE(check_output_file(folder_ / "missing" / "r.json"));
}

TEST_F(OutputFile, ANewOneNeverTakesThePlaceOfAnother) {
  EXPECT_TRUE(check_new_file(path_));
  ASSERT_TRUE(write_new_file(path_, "mine"));
  const auto written = write_new_file(path_, "other");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("there"));
  EXPECT_EQ(text_of(path_), "mine");
  EXPECT_EQ(files(), 1U);
  fs::create_symlink("gone.toml", folder_ / "link.toml");
  EXPECT_FALSE(check_new_file(folder_ / "link.toml"));
  EXPECT_FALSE(check_new_file(folder_ / "missing" / "bench.toml"));
}

} // namespace
} // namespace dyncal::inline base
