// A run folder on a disk that is too small, cannot be written, or fills up in the middle of a run:
// refused before the exciter moves, or everything that was promised is there.
//
// The disks are mounts in a mount namespace of this test's own; it is skipped where that is not
// permitted.
#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"
#include "tests/system/test_folder.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

LiveBenchSettings short_bench() {
  LiveBenchSettings settings;
  settings.bench_arguments = {"--speed", "4"};
  settings.excitation = R"(frequencies_hz = ["40", "80", "160"]
level = 10.0
repetitions = 2
settling_s = 0.5
duration_s = 1.0
)";
  return settings;
}

class SmallDisk : public testing::Test {
protected:
  void SetUp() override {
    if (unshare(CLONE_NEWNS) != 0 ||
        mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) {
      GTEST_SKIP() << "SKIPPED: no right to mount a small disk (" << std::strerror(errno)
                   << "): run it as root";
    }
    folder_ = fresh_folder_of_this_test();
    disk_ = folder_ / "disk";
    fs::create_directories(disk_);
  }
  void TearDown() override {
    if (!disk_.empty()) {
      umount2(disk_.c_str(), MNT_DETACH);
    }
  }
  // False where it is not permitted.
  [[nodiscard]] bool make_disk(const std::string& size, unsigned long flags = 0) const {
    return mount("tmpfs", disk_.c_str(), "tmpfs", flags, ("size=" + size).c_str()) == 0;
  }
  void expect_refused(LiveBench& bench, const std::string& sentence) const {
    ProgramRun& run = bench.start({"run", bench.bench_file(), "--folder", disk_ / "runs"});
    EXPECT_EQ(run.wait(patience), 1);
    EXPECT_THAT(run.errors(), HasSubstr(sentence));
    EXPECT_THAT(run.errors(), Not(HasSubstr("step 1 of")));
    EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
    EXPECT_FALSE(fs::exists(disk_ / "runs/live") && !fs::is_empty(disk_ / "runs/live"));
  }

  // Until this many values are in the only run of the bench.
  [[nodiscard]] bool wait_for_values(std::size_t values) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
      for (const auto& run : fs::directory_iterator(disk_ / "runs/live")) {
        const auto result = read_json(run.path() / "result.json");
        if (!result.is_discarded() && result["points"].size() >= values) {
          return true;
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10)); // between two looks
    }
    return false;
  }

  fs::path folder_;
  fs::path disk_;
};

TEST_F(SmallDisk, IsRefusedBeforeTheExciterMoves) {
  LiveBench bench(folder_, short_bench());
  if (!make_disk("4m")) {
    GTEST_SKIP() << "SKIPPED: no right to mount a tmpfs";
  }
  expect_refused(bench, "MB");
  ASSERT_EQ(mount("tmpfs", disk_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr), 0);
  expect_refused(bench, "Read-only file system");
}

TEST_F(SmallDisk, HasWhatWasPromisedWhenItFillsUpInTheRun) {
  LiveBench bench(folder_, short_bench());
  if (!make_disk("400m")) {
    GTEST_SKIP() << "SKIPPED: no right to mount a tmpfs";
  }
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--folder", disk_ / "runs"});
  ASSERT_TRUE(run.wait_for_error_text("step 4 of 6", patience)) << run.errors();
  ASSERT_TRUE(wait_for_values(6)) << run.errors();
  {
    std::ofstream filler(disk_ / "filler", std::ios::binary);
    const std::string megabyte(std::size_t{1} << 20U, 'x');
    while (filler.write(megabyte.data(), static_cast<std::streamsize>(megabyte.size())).flush()) {
    }
  }
  EXPECT_TRUE(run.wait(patience)) << "it must say that something is missing";
  EXPECT_TRUE(bench.wait_for_output("OFF"));
  fs::remove(disk_ / "filler");
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(disk_ / "runs/live")) {
    folders.push_back(entry.path());
  }
  ASSERT_EQ(folders.size(), 1U);
  const auto result = read_json(folders[0] / "result.json");
  ASSERT_FALSE(result.is_discarded());
  EXPECT_GE(result["points"].size(), 6U); // two steps of three channels at least were over
  ProgramRun check("dyncal", {"recording", "check", folders[0] / "recording.mcap"}, folder_);
  EXPECT_EQ(check.wait(patience), 0) << check.output() << check.errors();
  EXPECT_THAT(check.output(), HasSubstr("0 places are damaged"));
  const auto again_json = folder_ / "again.json";
  ProgramRun again("dyncal", {"analyse", folders[0], "--output", again_json}, folder_);
  EXPECT_TRUE(again.wait(patience) == 0 || again.errors().find("step") != std::string::npos)
      << again.errors();
  EXPECT_GE(read_json(again_json)["points"].size(), 6U) << again.errors();

  const fs::path tiny = folder_ / "tiny";
  fs::create_directories(tiny);
  ASSERT_EQ(mount("tmpfs", tiny.c_str(), "tmpfs", 0, "size=128k"), 0);
  for (const char* target : {"run.h5", "run.npz", "run", "run.mcap"}) {
    ProgramRun exported("dyncal", {"export", folders[0], "--output", tiny / target}, folder_);
    EXPECT_THAT(exported.wait(patience).value_or(-1), testing::AnyOf(1, 2)) << target;
    EXPECT_THAT(exported.errors(), testing::AnyOf(HasSubstr("No space left on device"),
                                                  HasSubstr("this build has no HDF5")));
    EXPECT_TRUE(fs::is_empty(tiny)) << target;
  }
  umount2(tiny.c_str(), MNT_DETACH);
}

} // namespace
} // namespace dyncal::tests
