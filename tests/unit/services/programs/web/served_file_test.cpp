#include "services/programs/web/served_file.hpp"

#include <sys/stat.h>

#include <fstream>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs::web {
namespace {

namespace fs = std::filesystem;

class OpenBeneath : public testing::Test {
protected:
  void SetUp() override {
    fs::create_directories(root_ / "inner");
    std::ofstream(root_ / "inner" / "file") << "hello";
    std::ofstream(folder_.path() / "secret") << "secret";
    fs::create_symlink("inner/file", root_ / "near");
    fs::create_directory_symlink("inner", root_ / "near-folder");
    fs::create_symlink("../secret", root_ / "out");
    fs::create_symlink(folder_.path() / "secret", root_ / "absolute");
    fs::create_directory_symlink(folder_.path(), root_ / "outside");
    ASSERT_EQ(mkfifo((root_ / "pipe").c_str(), 0600), 0);
  }
  [[nodiscard]] bool opens(const std::string& name, Links links) const {
    return open_beneath(root_, name, links).has_value();
  }
  tests::TemporaryFolder folder_;
  fs::path root_ = folder_.path() / "root";
};

TEST_F(OpenBeneath, FollowsNoLinkOrOnlyThoseThatStayWithin) {
  for (const Links links : {Links::none, Links::within}) {
    EXPECT_TRUE(opens("inner/file", links));
    for (const char* name : {"out", "absolute", "outside/secret", "../secret", "/etc/passwd",
                             "inner", "", "pipe", "no-such", "inner/../../secret"}) {
      EXPECT_FALSE(opens(name, links)) << name;
    }
  }
  for (const char* name : {"near", "near-folder/file"}) {
    EXPECT_TRUE(opens(name, Links::within)) << name;
    EXPECT_FALSE(opens(name, Links::none)) << name;
  }
}

TEST_F(OpenBeneath, TakesAFolderThatIsALinkItself) {
  fs::create_directory_symlink(root_, folder_.path() / "link-to-root");
  EXPECT_TRUE(open_beneath(folder_.path() / "link-to-root", "inner/file", Links::none));
  EXPECT_FALSE(open_beneath(folder_.path() / "no-such", "inner/file", Links::within));
}

TEST_F(OpenBeneath, GivesAChangedFileAnotherTag) {
  const auto before = open_beneath(root_, "inner/file", Links::none);
  const auto again = open_beneath(root_, "inner/file", Links::none);
  std::ofstream(root_ / "inner" / "file") << "hello, you";
  const auto after = open_beneath(root_, "inner/file", Links::none);
  ASSERT_TRUE(before && again && after);
  EXPECT_EQ(before->etag, again->etag);
  EXPECT_NE(before->etag, after->etag);
  EXPECT_EQ(after->bytes, 10U);
}

TEST(ParseRange, TakesOneOfBytes) {
  const auto is = [](std::string_view text, std::size_t first, std::size_t count) {
    const auto range = parse_range(text, 10);
    return range && range->count == count && (count == 0 || range->first == first);
  };
  EXPECT_TRUE(is("bytes=0-0", 0, 1));
  EXPECT_TRUE(is("bytes=2-5", 2, 4));
  EXPECT_TRUE(is("bytes=2-", 2, 8));
  EXPECT_TRUE(is("bytes=2-99999", 2, 8));
  EXPECT_TRUE(is("bytes=-3", 7, 3));
  EXPECT_TRUE(is("bytes=-30", 0, 10));
  EXPECT_TRUE(is("bytes=10-", 0, 0));
  EXPECT_TRUE(is("bytes=-0", 0, 0));
  for (const char* text :
       {"", "bytes", "bytes=", "bytes=-", "bytes=5-2", "bytes=0-1,3-4", "items=0-1", "bytes=a-b",
        "bytes=0-1x", "bytes=--1", "bytes=99999999999999999999-"}) {
    EXPECT_FALSE(parse_range(text, 10)) << text;
  }
  EXPECT_EQ(parse_range("bytes=0-", 0)->count, 0U);
}

TEST(NamesEtag, ComparesWeakly) {
  EXPECT_TRUE(names_etag("\"a\"", "\"a\""));
  EXPECT_TRUE(names_etag("\"b\", W/\"a\" ", "\"a\""));
  EXPECT_TRUE(names_etag("*", "\"a\""));
  for (const char* field : {"", ",", "a", "\"b\"", "\"ab\""}) {
    EXPECT_FALSE(names_etag(field, "\"a\"")) << field;
  }
}

} // namespace
} // namespace dyncal::inline programs::web
