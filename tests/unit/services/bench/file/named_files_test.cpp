#include "services/bench/file/named_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

namespace fs = std::filesystem;

TEST(PlaceOfCopy, IsThatBesideTheBenchFileWhereThatIsPossible) {
  EXPECT_EQ(place_of_copy("adc.json"), "adc.json");
  EXPECT_EQ(place_of_copy("./calibration//adc.json"), "calibration/adc.json");
  EXPECT_EQ(place_of_copy("calibration/../adc.json"), "adc.json");
}

TEST(PlaceOfCopy, KeepsFilesOfOtherFoldersApart) {
  EXPECT_EQ(place_of_copy("../adc.json"), "outside/up/adc.json");
  EXPECT_EQ(place_of_copy("../../lab/adc.json"), "outside/up/up/lab/adc.json");
  EXPECT_EQ(place_of_copy("/lab/adc.json"), "outside/root/lab/adc.json");
  EXPECT_NE(place_of_copy("/up/adc.json"), place_of_copy("../adc.json"));
}

TEST(PlaceOfCopy, LeavesTheNamesOfTheRunFolderToIt) {
  for (const char* name : {"result.json", "bench.toml", "log.txt", "recording.mcap",
                           "figures/a.csv", "recording-2.mcap", "outside/x", "shots.part"}) {
    EXPECT_EQ(place_of_copy(name), fs::path("outside/here") / name);
  }
}

constexpr const char* bench_text = R"(bench = "b"
[excitation]
frequencies_hz = ["20"]
level = 1.0
[sources.acs]
driver = "file"
path = "../acs.csv"
[sources.dau]
driver = "file"
path = "dau.csv"
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
)";

TEST(NamedFiles, AreKnownOfABenchFileAndFoundAmongCopies) {
  const tests::TemporaryFolder folder;
  fs::create_directories(folder.path() / "bench");
  fs::create_directories(folder.path() / "run/outside/up");
  for (const char* name : {"acs.csv", "bench/dau.csv", "run/outside/up/acs.csv", "run/dau.csv"}) {
    folder.write(name, "t_ns,sync\n");
  }
  const auto bench = read_bench_file(folder.write("bench/bench.toml", bench_text));
  ASSERT_TRUE(bench) << bench.error().message;
  ASSERT_EQ(bench->named_files.size(), 2U);
  EXPECT_EQ(bench->named_files[0].name, "../acs.csv");
  EXPECT_EQ(bench->named_files[0].path, folder.path() / "acs.csv");
  EXPECT_EQ(bench->named_files[1].path, folder.path() / "bench/dau.csv");

  const auto copy =
      read_bench_file(folder.write("run/bench.toml", bench_text), NamedFiles::Place::copies);
  ASSERT_TRUE(copy) << copy.error().message;
  EXPECT_EQ(copy->source("acs")->as<FileSourceSettings>()->path,
            folder.path() / "run/outside/up/acs.csv");
  EXPECT_EQ(copy->source("dau")->as<FileSourceSettings>()->path, folder.path() / "run/dau.csv");
  EXPECT_EQ(copy->sha256, bench->sha256);
}

} // namespace
} // namespace dyncal::inline bench
