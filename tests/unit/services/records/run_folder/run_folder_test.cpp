#include "services/records/run_folder/run_folder.hpp"

#include <fstream>
#include <iterator>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/named_files.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/run_folder/size_limit.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline records {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* bench_text = R"(bench = "bench-1"
[excitation]
frequencies_hz = ["20"]
level = 1.0
[sources.acs]
driver = "file"
path = "../acs.csv"
[sources.dau]
driver = "file"
path = "result.json"
[sources.shots]
driver = "series"
path = "shots"
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
[corrections]
dso_delay = { file = "calibration/delay.json" }
)";

class Folder : public testing::Test {
protected:
  void SetUp() override {
    fs::create_directories(temporary_.path() / "lab/calibration");
    fs::create_directories(temporary_.path() / "lab/shots");
    temporary_.write("acs.csv", "t_ns,reference,sync\n");
    temporary_.write("lab/result.json", "t_ns,sync\n");
    temporary_.write("lab/shots/step-1-shot-1.csv", "shot\n");
    temporary_.write("lab/calibration/delay.json", R"({"value_s": 1e-7, "u_s": 1e-9})");
    const auto read = read_bench_file(temporary_.write("lab/bench.toml", bench_text));
    ASSERT_TRUE(read) << read.error().message;
    bench_ = *read;
  }
  [[nodiscard]] Expected<std::unique_ptr<RunFolder>> create(const std::string& name) const {
    return RunFolder::create(root_, bench_, name);
  }
  static std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::set<std::string> files_of(const fs::path& folder) const {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) {
        files.insert(entry.path().lexically_relative(folder).string());
      }
    }
    return files;
  }

  tests::TemporaryFolder temporary_;
  fs::path root_ = temporary_.path() / "runs";
  BenchFile bench_;
};

TEST_F(Folder, HoldsTheBenchFileAndAllThatItNames) {
  const auto folder = create("20261122T101530.125Z");
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ((*folder)->path(), root_ / "bench-1/20261122T101530.125Z");
  EXPECT_EQ(
      files_of((*folder)->path()),
      (std::set<std::string>{"bench.toml", "calibration/delay.json", "outside/here/result.json",
                             "outside/up/acs.csv", "shots/step-1-shot-1.csv"}));
  EXPECT_EQ(text_of((*folder)->path() / "bench.toml"), bench_text);
  fs::remove_all(temporary_.path() / "lab"); // the copies stand for themselves
  fs::remove(temporary_.path() / "acs.csv");
  const auto copy =
      read_bench_file((*folder)->path() / copied_bench_file, NamedFiles::Place::copies);
  ASSERT_TRUE(copy) << copy.error().message;
  EXPECT_EQ(copy->corrections.dso_delay_s, 1e-7);
  EXPECT_EQ(copy->sha256, bench_.sha256);
}

TEST_F(Folder, IsNeverMadeOverAnother) {
  ASSERT_TRUE(create("run"));
  const std::string before = text_of(root_ / "bench-1/run/bench.toml");
  const auto second = create("run");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::bad_file);
  EXPECT_THAT(second.error().message, HasSubstr("the run folder cannot be made (File exists)"));
  EXPECT_EQ(text_of(root_ / "bench-1/run/bench.toml"), before);
  EXPECT_FALSE(fs::exists(root_ / "bench-1/run.part"));
}

TEST_F(Folder, IsRefusedWhereItCannotBeMade) {
  for (const fs::path& root : {temporary_.path() / "acs.csv", fs::path("/proc/runs")}) {
    const auto folder = RunFolder::create(root, bench_, "run");
    ASSERT_FALSE(folder) << root;
    EXPECT_EQ(folder.error().code, ErrorCode::bad_file);
    EXPECT_THAT(folder.error().message, HasSubstr(root.string()));
    EXPECT_THAT(folder.error().message, HasSubstr("--folder"));
  }
}

TEST_F(Folder, IsRefusedAndRemovedOnAFullDisk) {
  const tests::SizeLimit full(100);
  const auto folder = create("run");
  ASSERT_FALSE(folder);
  EXPECT_THAT(folder.error().message, HasSubstr("File too large"));
  EXPECT_TRUE(files_of(root_).empty());
  EXPECT_FALSE(fs::exists(root_ / "bench-1/run"));
}

TEST_F(Folder, NamesWhatTheRunNeedsAndWhatIsFree) {
  const auto folder = create("run");
  ASSERT_TRUE(folder);
  EXPECT_TRUE((*folder)->check_room({.recording_bytes = 1000, .results_bytes = 1000}));
  const auto room =
      (*folder)->check_room({.recording_bytes = 4'000'000'000'000'000, .results_bytes = 0});
  ASSERT_FALSE(room);
  EXPECT_THAT(room.error().message,
              testing::ContainsRegex("need about 4000000.0 GB but [0-9.]+ [GM]B are free there"));
}

TEST_F(Folder, BelongsToOneProgram) {
  auto folder = create("20261122T101530.125Z-monday");
  ASSERT_TRUE(folder);
  EXPECT_TRUE(is_in_use((*folder)->path()));
  const auto second = RunFolder::reopen(root_, bench_, "monday");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("another program writes into this run folder"));
  const fs::path path = (*folder)->path();
  folder->reset();
  EXPECT_FALSE(is_in_use(path));
}

TEST_F(Folder, IsFoundAgainByTheNameOfItsRun) {
  ASSERT_TRUE(create("20261122T101530.125Z-monday"));
  ASSERT_TRUE(create("20261122T101531.125Z-blue-monday"));
  ASSERT_TRUE(create("20261122T101529.125Z-monday"));
  const auto again = RunFolder::reopen(root_, bench_, "monday");
  ASSERT_TRUE(again && *again);
  EXPECT_EQ((*again)->path().filename(), "20261122T101530.125Z-monday");
  (*again)->discard(); // of an older run nothing is removed
  EXPECT_TRUE(fs::exists((*again)->path() / "bench.toml"));
  const auto none = RunFolder::reopen(root_, bench_, "tuesday");
  ASSERT_TRUE(none);
  EXPECT_EQ(*none, nullptr);
}

TEST_F(Folder, LeavesNothingOfARunThatExcitedNothing) {
  const auto folder = create("run");
  ASSERT_TRUE(folder);
  (*folder)->discard();
  EXPECT_FALSE(fs::exists(root_ / "bench-1"));
}

TEST_F(Folder, HasAFreeNameForEveryRecording) {
  const auto folder = create("run");
  ASSERT_TRUE(folder);
  EXPECT_EQ((*folder)->recording_path().filename(), "recording.mcap");
  std::ofstream((*folder)->path() / "recording.mcap") << "x";
  EXPECT_EQ((*folder)->recording_path().filename(), "recording-2.mcap");
}

TEST_F(Folder, EndsWithResultAndFigures) {
  const auto folder = create("run");
  ASSERT_TRUE(folder);
  const auto finished = (*folder)->finish(tests::example_outcome());
  ASSERT_TRUE(finished) << finished.error().message;
  const auto files = files_of((*folder)->path());
  EXPECT_TRUE(files.contains("result.json"));
  EXPECT_TRUE(files.contains("figures/transfer-function-dau-acceleration_z.svg"));
}

TEST_F(Folder, IsNotOpenedAgainWithAnotherBenchFile) {
  ASSERT_TRUE(create("monday.20261122T101531.125Z.00000001"));
  bench_.text += "# corrected\n";
  const auto again = RunFolder::reopen(root_, bench_, "monday");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::bad_file);
  EXPECT_THAT(again.error().message, HasSubstr("begun with another bench file"));
}

TEST_F(Folder, OfANameThatCameAgainIsTheNewest) {
  for (const char* name :
       {"monday.20261122T101531.125Z.00000001", "monday.20261122T101532.125Z.00000000",
        "20261122T101530.125Z-monday", "tuesday.20261122T101539.125Z.00000002"}) {
    ASSERT_TRUE(create(name));
  }
  EXPECT_EQ(find_run_folder(root_, "bench-1", "monday").filename(),
            "monday.20261122T101532.125Z.00000000");
  EXPECT_EQ(find_run_folder(root_, "bench-1", "monday.20261122T101531.125Z.00000001").filename(),
            "monday.20261122T101531.125Z.00000001");
  EXPECT_TRUE(find_run_folder(root_, "bench-1", "mon").empty());
}

TEST_F(Folder, IsNoLinkToAnother) {
  ASSERT_TRUE(create("monday.20261122T101531.125Z.00000001"));
  ASSERT_TRUE(create("tuesday.20261122T101532.125Z.00000002"));
  fs::create_directory_symlink(root_ / "bench-1/tuesday.20261122T101532.125Z.00000002",
                               root_ / "bench-1/monday.20261122T101539.125Z.00000003");
  EXPECT_EQ(find_run_folder(root_, "bench-1", "monday").filename(),
            "monday.20261122T101531.125Z.00000001");
}

TEST_F(Folder, OfARunIsFoundByItsNameWhereNothingHasThatPath) {
  for (const char* name :
       {"monday.20261122T101531.125Z.00000001", "monday.20261122T101532.125Z.00000000"}) {
    ASSERT_TRUE(create(name));
  }
  const fs::path bench = root_ / "bench-1";
  EXPECT_EQ(run_path(bench / "monday"), bench / "monday.20261122T101532.125Z.00000000");
  const fs::path exact = bench / "monday.20261122T101531.125Z.00000001";
  EXPECT_EQ(run_path(exact), exact);
  for (const char* other : {"mon", "monday.toml", "", "/", "monday/result.json"}) {
    EXPECT_EQ(run_path(other), other); // whatever is not there is named as it was typed
  }
  EXPECT_EQ(run_path(bench / "mon"), bench / "mon");
}

} // namespace
} // namespace dyncal::inline records
