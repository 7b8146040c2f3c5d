#include "services/records/mcap/repair.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/mcap/recorded_example.hpp"

namespace dyncal::inline records::recording {
namespace {

TEST(Repair, SavesAllWholeChunksOfAFileCutAtAHundredPlaces) {
  const tests::TemporaryFolder folder;
  write_example(folder.path() / "whole.mcap", {.chunks = 20});
  const std::string whole = file_text(folder.path() / "whole.mcap");
  for (std::size_t cut = 0; cut < 100; ++cut) {
    const std::size_t size = magic.size() + (cut + 1) * (whole.size() - magic.size()) / 101;
    const std::string damaged =
        folder.write("cut" + std::to_string(cut) + ".mcap", whole.substr(0, size));
    auto before = RecordingReader::open(damaged).value();
    const ExampleRead expected = read_example(before);
    const auto repaired = folder.path() / ("repaired" + std::to_string(cut) + ".mcap");
    const auto report = repair(damaged, repaired, "dyncal test");
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->damage_count, expected.report.damage_count);
    auto after = RecordingReader::open(repaired).value();
    const ExampleRead read = read_example(after);
    EXPECT_TRUE(read.report.ended_in_order);
    EXPECT_EQ(read.report.damage_count, 0U);
    EXPECT_EQ(read.numbers, expected.numbers);
    EXPECT_EQ(read.attachments, expected.attachments);
    EXPECT_EQ(read.metadata, expected.metadata + 1);
  }
}

TEST(Repair, LeavesAFileThatIsThereAsItIs) {
  const tests::TemporaryFolder folder;
  write_example(folder.path() / "a.mcap");
  folder.write("b.mcap", "mine");
  EXPECT_FALSE(repair(folder.path() / "a.mcap", folder.path() / "b.mcap", "dyncal test"));
  EXPECT_EQ(file_text(folder.path() / "b.mcap"), "mine");
}

TEST(Repair, CountsWhatIsReadAndThenWhatIsCopied) {
  const tests::TemporaryFolder folder;
  write_example(folder.path() / "a.mcap", {.chunks = 40, .messages = 1000});
  const std::string whole = file_text(folder.path() / "a.mcap");
  const auto damaged = folder.write("cut.mcap", whole.substr(0, whole.size() - 100'000));
  const std::size_t megabytes = (whole.size() - 100'000) / 1'000'000;
  ASSERT_GE(megabytes, 2U);
  const auto count = std::make_shared<base::WorkCount>("opening");
  ASSERT_TRUE(repair(damaged, folder.path() / "b.mcap", "dyncal test", count));
  EXPECT_EQ(count->state().what, "copying");
  EXPECT_EQ(count->state().total, megabytes);
  EXPECT_EQ(count->state().done, megabytes);
  ASSERT_TRUE(repair(damaged, folder.path() / "c.mcap", "dyncal test"));
  EXPECT_EQ(file_text(folder.path() / "b.mcap"), file_text(folder.path() / "c.mcap"));
}

// So that a part of it is not taken for the whole: it has another name until the end.
TEST(Repair, TakesItsNameAtTheEnd) {
  const tests::TemporaryFolder folder;
  write_example(folder.path() / "a.mcap", {.chunks = 40, .messages = 1000});
  folder.write("b.mcap.part", "of a repair that was interrupted");
  const auto repaired = folder.path() / "b.mcap";
  std::mutex mutex;
  std::condition_variable_any ended;
  bool seen_early = false;
  std::jthread watcher([&](const std::stop_token& stop) {
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      // Nothing of that name may be there that did not end in order.
      if (std::filesystem::exists(repaired)) {
        auto reader = RecordingReader::open(repaired).value();
        seen_early = seen_early || !read_example(reader).report.ended_in_order;
      }
      ended.wait_for(lock, stop, std::chrono::milliseconds(1), [] { return false; });
    }
  });
  ASSERT_TRUE(repair(folder.path() / "a.mcap", repaired, "dyncal test"));
  watcher.request_stop();
  watcher.join();
  EXPECT_FALSE(seen_early);
  EXPECT_TRUE(std::filesystem::exists(repaired));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "b.mcap.part"));
}

TEST(Repair, LeavesNothingOfARepairThatFailed) {
  const tests::TemporaryFolder folder;
  write_example(folder.path() / "a.mcap");
  std::filesystem::create_directory(folder.path() / "b.mcap");
  EXPECT_FALSE(repair(folder.path() / "a.mcap", folder.path() / "b.mcap", "dyncal test"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "b.mcap.part"));
}

} // namespace
} // namespace dyncal::inline records::recording
