#include "services/web/run_files.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::services::web {
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

TEST(PercentEncoded, LeavesNothingThatAnAddressDivides) {
  EXPECT_EQ(percent_encoded("acc-1_.~"), "acc-1_.~");
  EXPECT_EQ(percent_encoded("a/b c?\xc3\xa4"), "a%2Fb%20c%3F%C3%A4");
}

TEST(MediaType, IsThatOfTheName) {
  EXPECT_EQ(media_type("x.svg"), "image/svg+xml");
  EXPECT_EQ(media_type("x.mcap"), "application/octet-stream");
}

} // namespace
} // namespace dyncal::services::web
