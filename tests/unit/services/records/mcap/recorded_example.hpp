// A small recording for tests: chunks of messages whose bytes follow from their numbers, so that a
// reader can tell whether a value is right. One thread.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "services/records/mcap/recording_reader.hpp"
#include "services/records/mcap/recording_writer.hpp"
#include "services/records/mcap/text_crc.hpp"

namespace dyncal::inline records::recording {

inline WriterOptions example_options(Compression compression = Compression::none) {
  WriterOptions options;
  options.library = "dyncal test";
  options.schemas = {{1, "m::A", "omgidl", "module m { struct A { long a; }; };\n"}};
  for (std::uint16_t id = 1; id <= 2; ++id) {
    options.channels.push_back({id,
                                1,
                                id == 1 ? "First" : "Second",
                                "cdr",
                                {{schema_crc_key, schema_crc(options.schemas.front())}}});
  }
  options.compression = compression;
  return options;
}

// Of message `number`: its length and bytes follow from it.
inline std::string example_data(std::uint32_t number) {
  std::string data;
  for (std::uint32_t i = 0; i < 40 + number % 7; ++i) {
    data.push_back(static_cast<char>(number * 31 + i * 7));
  }
  return data;
}

inline Chunk example_chunk(const WriterOptions& options, std::uint32_t first, std::uint32_t count) {
  Chunk chunk;
  for (std::uint32_t number = first; number < first + count; ++number) {
    const std::string data = example_data(number);
    Message message;
    message.channel_id = static_cast<std::uint16_t>(1 + number % 2);
    message.sequence = number;
    message.log_time = 1'000'000'000ULL + number;
    message.publish_time = message.log_time;
    message.data = data;
    chunk.add(options.channels[number % 2], message);
  }
  return chunk;
}

struct ExampleSize {
  std::uint32_t chunks = 10;
  std::uint32_t messages = 8; // of a chunk
  bool ended = true;
  Compression compression = Compression::none;
};

// Messages 0, 1, ...; metadata first and last, an attachment behind the first chunk.
inline void write_example(const std::filesystem::path& path, const ExampleSize& size = {}) {
  const WriterOptions options = example_options(size.compression);
  auto writer = RecordingWriter::create(path, options).value();
  EXPECT_TRUE(writer.add_metadata({"dyncal.recording", {{"bench", "acc-1"}}}));
  for (std::uint32_t chunk = 0; chunk < size.chunks; ++chunk) {
    EXPECT_TRUE(writer.add_chunk(example_chunk(options, chunk * size.messages, size.messages)));
    if (chunk == 0) {
      EXPECT_TRUE(
          writer.add_attachment({5, "recipe.toml", "application/toml", "bench = \"acc-1\"\n"}));
    }
  }
  EXPECT_TRUE(writer.add_metadata({"dyncal.losses", {{"dau.missing", "0"}}}));
  if (size.ended) {
    EXPECT_TRUE(writer.close());
  }
}

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline RecordingReader reader_of(const std::string& bytes) {
  drivers::FileDescriptor file(memfd_create("recording", MFD_CLOEXEC));
  EXPECT_EQ(::pwrite(file.number(), bytes.data(), bytes.size(), 0),
            static_cast<ssize_t>(bytes.size()));
  return RecordingReader::read(std::move(file), "example.mcap").value();
}

// What a reader gives of the example, checked: no message that is not one of it.
struct ExampleRead {
  ScanReport report;
  std::vector<std::uint32_t> numbers;
  std::size_t attachments = 0;
  std::size_t metadata = 0;
};

inline ExampleRead read_example(RecordingReader& reader) {
  ExampleRead read;
  const auto report = reader.scan(
      {.message =
           [&](const MessageInFile& one) {
             EXPECT_EQ(one.message.data, example_data(one.message.sequence));
             EXPECT_EQ(one.channel.topic, one.message.sequence % 2 == 0 ? "First" : "Second");
             EXPECT_EQ(one.message.log_time, 1'000'000'000ULL + one.message.sequence);
             read.numbers.push_back(one.message.sequence);
           },
       .attachment =
           [&](const Attachment& attachment) {
             EXPECT_EQ(attachment.data, "bench = \"acc-1\"\n");
             ++read.attachments;
           },
       .metadata =
           [&](const Metadata& metadata) {
             EXPECT_TRUE(metadata.entries.contains("bench") ||
                         metadata.entries.contains("dau.missing") ||
                         metadata.name == "dyncal.repair");
             ++read.metadata;
           }});
  EXPECT_TRUE(report) << report.error().message;
  read.report = report.value_or(ScanReport{});
  return read;
}

} // namespace dyncal::inline records::recording
