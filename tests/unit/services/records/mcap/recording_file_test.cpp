#include "services/records/mcap/recording_file.hpp"

#include <csignal>
#include <random>

#include <sys/wait.h>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/mcap/recorded_example.hpp"

namespace dyncal::inline records::recording {
namespace {

// The last 50 bytes are DataEnd, Footer and magic, and the records before them follow each other.
void expect_whole(const std::string& file, const std::string& when) {
  ASSERT_GT(file.size(), 60U) << when;
  EXPECT_EQ(file.substr(file.size() - magic.size()), magic) << when;
  EXPECT_EQ(file[file.size() - 37], 0x02) << when;
  RecordingReader reader = reader_of(file);
  EXPECT_EQ(read_example(reader).report.damage_count, 0U) << when;
}

TEST(RecordingFile, IsWholeAfterEveryRecord) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "a.mcap";
  const WriterOptions options = example_options();
  auto writer = RecordingWriter::create(path, options).value();
  expect_whole(file_text(path), "empty");
  for (std::uint32_t chunk = 0; chunk < 10; ++chunk) {
    ASSERT_TRUE(writer.add_chunk(example_chunk(options, chunk * 5, 5)));
    const std::string file = file_text(path);
    expect_whole(file, std::to_string(chunk));
    RecordingReader reader = reader_of(file);
    EXPECT_EQ(read_example(reader).numbers.size(), (chunk + 1) * 5);
  }
  ASSERT_TRUE(writer.close());
  RecordingReader reader = RecordingReader::open(path).value();
  const ExampleRead read = read_example(reader);
  EXPECT_TRUE(read.report.ended_in_order);
  EXPECT_EQ(read.numbers.size(), 50U);
  EXPECT_EQ(read.report.file_bytes, std::filesystem::file_size(path));
}

// A process that only writes is killed at random instants: what it had acknowledged is there, and
// the file is whole.
TEST(RecordingFile, IsWholeWhenItsWriterIsKilled) {
  const tests::TemporaryFolder folder;
  std::mt19937 draw(7);
  for (int kill_number = 0; kill_number < 20; ++kill_number) {
    const auto path = folder.path() / (std::to_string(kill_number) + ".mcap");
    auto* acknowledged = static_cast<volatile std::uint32_t*>(
        ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    const pid_t child = ::fork();
    if (child == 0) {
      const WriterOptions options = example_options();
      auto writer = RecordingWriter::create(path, options).value();
      for (std::uint32_t first = 0;; first += 1000) {
        if (!writer.add_chunk(example_chunk(options, first, 1000))) {
          ::_exit(1);
        }
        *acknowledged = first + 1000;
      }
    }
    while (*acknowledged == 0) {
    }
    ::usleep(std::uniform_int_distribution<useconds_t>(0, 20'000)(draw));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    auto reader = RecordingReader::open(path).value();
    const ExampleRead read = read_example(reader);
    EXPECT_EQ(read.report.damage_count, 0U);
    EXPECT_GE(read.numbers.size(), *acknowledged);
    ::munmap(const_cast<std::uint32_t*>(acknowledged), 4096);
  }
}

TEST(RecordingFile, DoesNotReplaceAnother) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "a.mcap";
  folder.write("a.mcap", "something else");
  const auto file = RecordingFile::create(path, magic);
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("is there already"), std::string::npos);
  EXPECT_EQ(file_text(path), "something else");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(RecordingFile, NamesAFolderThatIsNotThere) {
  const auto file = RecordingFile::create("/nowhere/a.mcap", magic);
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("/nowhere/a.mcap"), std::string::npos);
}

} // namespace
} // namespace dyncal::inline records::recording
