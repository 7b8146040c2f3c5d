#include "services/records/mcap/recording_reader.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/mcap/recorded_example.hpp"

namespace dyncal::inline records::recording {
namespace {

std::string example(const ExampleSize& size = {}) {
  const tests::TemporaryFolder folder;
  const auto path = folder.path() / "a.mcap";
  write_example(path, size);
  return file_text(path);
}

TEST(RecordingReader, ReadsEverything) {
  for (const bool ended : {true, false}) {
    RecordingReader reader = reader_of(example({.ended = ended}));
    const ExampleRead read = read_example(reader);
    EXPECT_EQ(read.numbers.size(), 80U);
    EXPECT_EQ(read.attachments, 1U);
    EXPECT_EQ(read.metadata, 2U);
    EXPECT_EQ(read.report.chunks, 10U);
    EXPECT_EQ(read.report.damage_count, 0U);
    EXPECT_EQ(read.report.ended_in_order, ended);
  }
}

TEST(RecordingReader, ReadsAForeignFileWithoutChunks) {
  std::string file(magic);
  append_header(file, "other 1.0");
  append_channel(file, {.id = 3, .topic = "/imu", .message_encoding = "json", .metadata = {}});
  for (std::uint32_t i = 0; i < 5; ++i) {
    append_message(file, {.channel_id = 3, .sequence = i, .log_time = i, .data = "{}"});
  }
  append_data_end(file, 0);
  append_footer(file, {});
  file += magic;
  RecordingReader reader = reader_of(file);
  std::vector<std::uint64_t> places;
  ScanEvents events;
  events.message = [&](const MessageInFile& message) {
    EXPECT_EQ(message.message.sequence, places.size());
    EXPECT_EQ(message.message.data, "{}");
    EXPECT_EQ(message.position, 0U);
    places.push_back(message.chunk);
  };
  const auto report = reader.scan(events);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->messages, 5U);
  EXPECT_EQ(report->loose_messages, 5U);
  EXPECT_EQ(report->damage_count, 0U);
  ASSERT_EQ(places.size(), 5U);
  EXPECT_TRUE(reader.chunk_records(places[2])->ends_with("{}")); // found again
}

// Nothing is known of it: it is neither damaged nor lost.
TEST(RecordingReader, NamesACompressionThatItDoesNotKnow) {
  std::string file(magic);
  append_header(file, "other 1.0");
  append_chunk_head(file, {.uncompressed_size = 9, .compression = "brotli", .records = {}}, 4);
  file += "????";
  append_data_end(file, 0);
  append_footer(file, {});
  file += magic;
  const auto report = reader_of(file).scan({});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->unknown_chunks, 1U);
  EXPECT_EQ(report->lost_chunks, 0U);
  ASSERT_EQ(report->damages.size(), 1U);
  EXPECT_NE(report->damages[0].what.find("'brotli' is not known to this build"), std::string::npos);
}

TEST(RecordingReader, ReadsCompressedChunks) {
  if (!parse_compression("zstd")) {
    GTEST_SKIP() << "this build has no zstd";
  }
  RecordingReader reader = reader_of(example({.messages = 100, .compression = Compression::zstd}));
  EXPECT_EQ(read_example(reader).numbers.size(), 1000U);
}

// Never a wrong value (read_example), and never a loss that is not stated.
TEST(RecordingReader, StatesEveryLossOfABitThatIsFlippedAnywhere) {
  const std::string whole = example({.chunks = 3, .messages = 3});
  for (std::size_t at = magic.size(); at < whole.size(); ++at) {
    std::string file = whole;
    file[at] = static_cast<char>(file[at] ^ (1 << (at % 8)));
    RecordingReader reader = reader_of(file);
    const ExampleRead read = read_example(reader);
    EXPECT_GT(read.report.damage_count, 0U) << at;
    EXPECT_GE(read.numbers.size(), 3U) << at << ": more than one chunk is lost";
  }
}

// As it is while it is written, but with a smaller filler.
std::string example_that_goes_on(std::size_t& sound) {
  const std::string file = example({.chunks = 3, .messages = 3, .ended = false});
  sound = file.find(std::string(4096, '\0')) - 5; // of a length below 2^32
  std::string smaller = file.substr(0, sound);
  append_head(smaller, Opcode::filler, 500);
  smaller += std::string(500, '\0');
  append_data_end(smaller, 0);
  append_footer(smaller, {});
  return smaller + std::string(magic);
}

TEST(RecordingReader, StatesEveryLossOfABitThatIsFlippedInARecordingThatWasNotEnded) {
  std::size_t sound = 0;
  const std::string whole = example_that_goes_on(sound);
  RecordingReader untouched = reader_of(whole);
  ASSERT_EQ(read_example(untouched).numbers.size(), 9U);
  std::size_t unstated = 0;
  for (std::size_t at = magic.size(); at < whole.size(); ++at) {
    std::string file = whole;
    file[at] = static_cast<char>(file[at] ^ (1 << (at % 8)));
    RecordingReader reader = reader_of(file);
    const ExampleRead read = read_example(reader);
    const bool has_all = read.numbers.size() == 9 && read.metadata == 2 && read.attachments == 1;
    EXPECT_TRUE(has_all || read.report.damage_count > 0) << at;
    unstated += at < sound && read.report.damage_count == 0 ? 1 : 0;
  }
  // In the name of the library, in times of heads and in indexes, by which nothing is read.
  EXPECT_LT(unstated, (sound - magic.size()) / 2);
}

TEST(RecordingReader, ReadsAllWholeChunksOfAFileThatWasCut) {
  const std::string whole = example({.chunks = 20});
  std::mt19937 draw(3);
  std::size_t least = 0;
  for (int cut = 0; cut < 100; ++cut) {
    const std::size_t size =
        magic.size() + static_cast<std::size_t>(cut + 1) * (whole.size() - 10) / 102;
    std::string part = whole.substr(0, size);
    if (cut % 5 == 0) {
      part += std::string(std::uniform_int_distribution<std::size_t>(1, 70'000)(draw), '\0');
    }
    RecordingReader reader = reader_of(part);
    const ExampleRead read = read_example(reader);
    EXPECT_GT(read.report.damage_count, 0U) << size;
    EXPECT_EQ(read.numbers.size() % 8, 0U);
    EXPECT_GE(read.numbers.size(), least) << "a longer part holds as much";
    least = read.numbers.size();
    for (std::size_t i = 0; i < read.numbers.size(); ++i) {
      EXPECT_EQ(read.numbers[i], i);
    }
  }
  EXPECT_EQ(least, 160U);
}

TEST(RecordingReader, GoesOnBehindALengthThatIsWrong) {
  std::string file = example();
  RecordingReader sound = reader_of(file);
  std::vector<std::uint64_t> chunks;
  (void)sound.scan({.message = [&](const MessageInFile& one) {
    if (chunks.empty() || chunks.back() != one.chunk) {
      chunks.push_back(one.chunk);
    }
  }});
  ASSERT_EQ(chunks.size(), 10U);
  file[chunks[3] + 2] = '\x7f';
  RecordingReader reader = reader_of(file);
  const ExampleRead read = read_example(reader);
  EXPECT_EQ(read.numbers.size(), 72U);
  ASSERT_FALSE(read.report.damages.empty());
  EXPECT_EQ(read.report.damages.front().offset, chunks[3]);
  EXPECT_NE(to_string(read.report.damages.front(), "a.mcap").find("a.mcap: at byte"),
            std::string::npos);
}

TEST(RecordingReader, RefusesAnotherFile) {
  const tests::TemporaryFolder folder;
  const auto reader = RecordingReader::open(folder.write("a.mcap", "SQLite format 3"));
  ASSERT_FALSE(reader);
  EXPECT_NE(reader.error().message.find("not an MCAP recording"), std::string::npos);
  EXPECT_FALSE(RecordingReader::open(folder.path()));
  EXPECT_FALSE(RecordingReader::open(folder.path() / "none.mcap"));
  EXPECT_FALSE(RecordingReader::open(folder.write("empty.mcap", "")));
}

// Whatever has happened to the file, so that the time left can be told.
TEST(RecordingReader, TellsHowFarItHasWalked) {
  const std::string whole = example({.chunks = 6, .messages = 200});
  std::string damaged = whole;
  std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(whole.size() / 3), 5000, '\x06');
  for (const std::string& file :
       {whole, whole.substr(0, whole.size() / 2), damaged, whole + std::string(3'000'000, 'x'),
        std::string(magic) + std::string(3'000'000, '\0')}) {
    RecordingReader reader = reader_of(file);
    std::vector<std::uint64_t> walked;
    ASSERT_TRUE(reader.scan({.walked = [&](std::uint64_t bytes) {
      walked.push_back(bytes);
      return true;
    }}));
    ASSERT_FALSE(walked.empty());
    EXPECT_TRUE(std::is_sorted(walked.begin(), walked.end()));
    EXPECT_EQ(walked.back(), file.size());
  }
}

TEST(RecordingReader, StopsWhereItIsAskedTo) {
  const std::string whole = example({.chunks = 6, .messages = 200});
  for (const std::string& file : {whole, std::string(magic) + std::string(3'000'000, '\0')}) {
    RecordingReader reader = reader_of(file);
    std::size_t asked = 0;
    const auto report = reader.scan({.walked = [&](std::uint64_t) { return ++asked < 2; }});
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, base::ErrorCode::interrupted);
    EXPECT_EQ(asked, 2U);
  }
}

} // namespace
} // namespace dyncal::inline records::recording
