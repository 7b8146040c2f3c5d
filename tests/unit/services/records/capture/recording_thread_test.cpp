#include "services/records/capture/recording_thread.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/mcap/recorded_example.hpp"

namespace dyncal::inline records::recording {
namespace {

TEST(RecordingThread, WritesWhatIsPutAndEndsTheFile) {
  const tests::TemporaryFolder folder;
  const WriterOptions options = example_options();
  {
    RecordingThread thread(RecordingWriter::create(folder.path() / "a.mcap", options).value(),
                           1 << 20, 0);
    thread.note_losses({"dyncal.losses", {{"dau.missing", "3"}}});
    for (std::uint32_t first = 0; first < 100; first += 10) {
      ASSERT_TRUE(thread.has_room(1000));
      thread.put(example_chunk(options, first, 10));
    }
    ASSERT_TRUE(thread.close());
    EXPECT_EQ(thread.figures().stored, 100U);
    EXPECT_EQ(thread.figures().not_stored, 0U);
    EXPECT_TRUE(thread.figures().ended);
    EXPECT_EQ(thread.figures().problem, "");
  }
  auto reader = RecordingReader::open(folder.path() / "a.mcap").value();
  const ExampleRead read = read_example(reader);
  EXPECT_TRUE(read.report.ended_in_order);
  EXPECT_EQ(read.numbers.size(), 100U);
  EXPECT_EQ(read.metadata, 1U);
}

TEST(RecordingThread, EndsInOrderWhenTheDiskIsNearlyFull) {
  const tests::TemporaryFolder folder;
  const WriterOptions options = example_options();
  RecordingThread thread(RecordingWriter::create(folder.path() / "a.mcap", options).value(),
                         1 << 20, std::uint64_t{1} << 62U);
  thread.put(example_chunk(options, 0, 10));
  ASSERT_TRUE(thread.close());
  EXPECT_EQ(thread.figures().stored, 0U);
  EXPECT_EQ(thread.figures().not_stored, 10U);
  EXPECT_NE(thread.figures().problem.find("nearly full"), std::string::npos);
  auto reader = RecordingReader::open(folder.path() / "a.mcap").value();
  EXPECT_TRUE(read_example(reader).report.ended_in_order);
}

TEST(RecordingThread, HasABound) {
  const tests::TemporaryFolder folder;
  RecordingThread thread(
      RecordingWriter::create(folder.path() / "a.mcap", example_options()).value(), 1000, 0);
  EXPECT_TRUE(thread.has_room(1000));
  EXPECT_FALSE(thread.has_room(1001));
}

} // namespace
} // namespace dyncal::inline records::recording
