#include "services/bench/file/driver_tables.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

class FileKeys : public testing::Test {
protected:
  FileKeys() {
    for (const char* name :
         {"one.csv", "laser.tdms", "at 10:20.csv", "r.sigmf-meta", "r.sigmf-data"}) {
      std::ofstream(folder / name) << "t_ns,x\n";
    }
  }

  [[nodiscard]] Expected<BenchFile> bench(const std::string& keys) const {
    return parse_bench_file("bench = \"acc-1\"\n[excitation]\nfrequencies_hz = [\"10\"]\n"
                            "level = 10.0\n[generator]\ndriver = \"none\"\n"
                            "[method]\nkind = \"analogue\"\nreference = \"acs/x\"\n"
                            "dut = [\"acs/y\"]\n[sources.acs]\ndriver = \"file\"\n" +
                                keys,
                            folder / "bench.toml");
  }
  [[nodiscard]] std::string problem(const std::string& keys) const {
    const auto file = bench(keys);
    return file ? "accepted" : file.error().message;
  }
  [[nodiscard]] FileSourceSettings source(const std::string& keys) const {
    const auto file = bench(keys);
    EXPECT_TRUE(file) << (file ? "" : file.error().message);
    return file ? *file->source("acs")->as<FileSourceSettings>() : FileSourceSettings{};
  }

  const tests::TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
};

TEST_F(FileKeys, NameAFileOrChannelsInFiles) {
  EXPECT_EQ(source("path = \"one.csv\"\n").path, folder / "one.csv");
  EXPECT_TRUE(source("path = \"one.csv\"\n").single.empty());
  EXPECT_EQ(source("path = \"at 10:20.csv\"\n").path, folder / "at 10:20.csv");
  const auto channel = source("path = \"laser.tdms:Group: 1/Velocity\"\n");
  ASSERT_EQ(channel.single.size(), 1U);
  EXPECT_EQ(channel.single[0].path, folder / "laser.tdms");
  EXPECT_EQ(channel.single[0].name, "Group: 1/Velocity");
  const auto list = source("path = [\"laser.tdms:g/v\", \"one.csv:x\"]\n");
  ASSERT_EQ(list.single.size(), 2U);
  EXPECT_EQ(list.path, folder / "laser.tdms");
  EXPECT_EQ(list.single[1].name, "x");
}

TEST_F(FileKeys, NameBothFilesOfARecording) {
  const auto file = bench("path = \"r.sigmf-meta\"\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->source("acs")->as<FileSourceSettings>()->path, folder / "r.sigmf-data");
  EXPECT_EQ(file->named_files.size(), 2U);
}

TEST_F(FileKeys, ScaleChannelsAndMoveTimes) {
  const auto file =
      source("path = \"one.csv\"\ntime_offset_s = -37\nscale = { x = 10, y = -0.5 }\n");
  EXPECT_EQ(file.time_offset_s, -37.0);
  EXPECT_EQ(file.scale, (std::map<std::string, double>{{"x", 10.0}, {"y", -0.5}}));
}

TEST_F(FileKeys, AreRefusedWithTheirReason) {
  EXPECT_THAT(problem("path = \"two.csv\"\n"), HasSubstr("two.csv, which does not exist"));
  EXPECT_THAT(problem("path = [\"one.csv\"]\n"), HasSubstr("but no channel in it"));
  EXPECT_THAT(problem("path = [\"two.csv:x\"]\n"), HasSubstr("two.csv, which does not exist"));
  EXPECT_THAT(problem("path = []\n"), HasSubstr("must name a file, or channels"));
  EXPECT_THAT(problem("path = \"one.csv\"\nscale = { x = 0 }\n"), HasSubstr("the factor 0"));
  EXPECT_THAT(problem("path = \"one.csv\"\nscale = { x = \"2\" }\n"),
              HasSubstr("must give a number for 'x'"));
  EXPECT_THAT(problem("path = \"one.csv\"\nscale = 2\n"), HasSubstr("must be a table of numbers"));
  EXPECT_THAT(problem("path = \"one.csv\"\ntime_offset_s = 2e9\n"), HasSubstr("-1e9 to 1e9"));
}

} // namespace
} // namespace dyncal::inline bench
