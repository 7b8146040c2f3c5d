#include "services/programs/web/run_files.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs::web {
namespace {

namespace fs = std::filesystem;

class RunFilesTest : public testing::Test {
protected:
  void SetUp() override {
    const fs::path run = folder_.path() / "runs" / "acc-1" / "20261122T101530.125Z-r1";
    fs::create_directories(run / "figures");
    std::ofstream(run / "result.json") << "{}";
    std::ofstream(run / "figures" / "magnitude.svg") << "<svg/>";
    std::ofstream(run / "report.pdf.part") << "half of";
    std::ofstream(folder_.path() / "secret") << "secret";
    fs::create_symlink(folder_.path() / "secret", run / "link.txt");
    fs::create_directory_symlink(folder_.path(), run / "outside");
  }
  tests::TemporaryFolder folder_;
  RunFiles files_{folder_.path() / "runs"};
};

TEST_F(RunFilesTest, ListsTheFilesOfARunButNoLinksAndNoneThatIsStillWritten) {
  const auto files = files_.files_of("acc-1", "r1");
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[0].name, "figures/magnitude.svg");
  EXPECT_EQ(files[1].name, "result.json");
  EXPECT_EQ(files[1].bytes, 2U);
  EXPECT_TRUE(files_.find("acc-1", "r1", "result.json"));
}

TEST_F(RunFilesTest, OpensNothingElse) {
  for (const char* name : {"link.txt", "outside/secret", "../r1/result.json", "./result.json", "",
                           "/etc/passwd", "figures", "figures/../result.json"}) {
    EXPECT_FALSE(files_.find("acc-1", "r1", name)) << name;
  }
  for (const char* bench : {"", ".", "..", "../runs/acc-1", "acc-1/.."}) {
    EXPECT_FALSE(files_.find(bench, "r1", "result.json")) << bench;
  }
  for (const char* run : {"", ".", "..", "../../acc-1", "r2"}) {
    EXPECT_FALSE(files_.find("acc-1", run, "result.json")) << run;
  }
  EXPECT_TRUE(RunFiles("").files_of("acc-1", "r1").empty());
}

// Whoever may write among the runs has no other folder served by it.
TEST_F(RunFilesTest, FollowsNoLinkToABenchOrARun) {
  const fs::path other = folder_.path() / "other" / "acc-2" / "20261122T101530.125Z-r2";
  fs::create_directories(other);
  std::ofstream(other / "result.json") << "{}";
  const fs::path runs = folder_.path() / "runs";
  fs::create_directory_symlink(other.parent_path(), runs / "acc-2");
  fs::create_directory_symlink(other, runs / "acc-1" / other.filename());
  EXPECT_TRUE(files_.files_of("acc-2", "r2").empty());
  EXPECT_TRUE(files_.files_of("acc-1", "r2").empty());
  const RunFiles by_link(folder_.path() / "link-to-runs"); // the folder itself may be one
  fs::create_directory_symlink(runs, folder_.path() / "link-to-runs");
  EXPECT_EQ(by_link.files_of("acc-1", "r1").size(), 2U);
  const auto file = by_link.find("acc-1", "r1", "figures/magnitude.svg");
  ASSERT_TRUE(file);
  EXPECT_EQ(by_link.open(*file)->bytes, 6U);
}

TEST_F(RunFilesTest, OpensNoFileThatHasBecomeALink) {
  const auto file = files_.find("acc-1", "r1", "result.json");
  ASSERT_TRUE(file);
  EXPECT_TRUE(files_.open(*file));
  fs::remove(file->path);
  fs::create_symlink(folder_.path() / "secret", file->path);
  EXPECT_FALSE(files_.open(*file));
}

TEST(PercentEncoded, LeavesNothingThatAnAddressDivides) {
  EXPECT_EQ(percent_encoded("acc-1_.~"), "acc-1_.~");
  EXPECT_EQ(percent_encoded("a/b c?\xc3\xa4"), "a%2Fb%20c%3F%C3%A4");
}

TEST(MediaType, IsThatOfTheName) {
  EXPECT_EQ(media_type("x.svg"), "image/svg+xml");
  EXPECT_EQ(media_type("x.mcap"), "application/octet-stream");
}

} // namespace
} // namespace dyncal::inline programs::web
