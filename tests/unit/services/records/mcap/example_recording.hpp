// A recording whose messages a test adds one by one, a millisecond apart. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "services/records/capture/recorded_topics.hpp"
#include "services/records/mcap/recording_writer.hpp"

namespace dyncal::inline records {

inline constexpr std::int64_t example_utc_ns = 1'700'000'000'123'456'789;

struct ExampleRecording {
  explicit ExampleRecording(const std::filesystem::path& path)
      : writer(recording::RecordingWriter::create(
                   path, {"dyncal test", recording::recorded_schemas(),
                          recording::recorded_channels(), recording::Compression::none})
                   .value()) {}

  template <class T>
  void add(const std::string& topic, const T& message) {
    const std::string bytes = recording::encode(message);
    recording::Chunk chunk;
    recording::Message one;
    one.channel_id = recording::channel_of(topic).id;
    one.sequence = sequence++;
    one.log_time = static_cast<std::uint64_t>(example_utc_ns) + std::uint64_t{sequence} * 1'000'000;
    one.publish_time = one.log_time - 17;
    one.data = bytes;
    chunk.add(recording::channel_of(topic), one);
    EXPECT_TRUE(writer.add_chunk(chunk));
  }

  recording::RecordingWriter writer;
  std::uint32_t sequence = 0;
};

} // namespace dyncal::inline records
