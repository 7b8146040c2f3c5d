// One walk of the reader through a file (recording_reader.hpp). One thread.
#pragma once

#include <map>
#include <optional>
#include <set>

#include "services/records/mcap/chunk_search.hpp"
#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records::recording {

class Scan {
public:
  Scan(const RecordingReader& reader, const ScanEvents& events)
      : reader_(reader), events_(events), chunks_(reader) {}

  [[nodiscard]] base::Expected<ScanReport> run();

private:
  // What a record turned out to be.
  enum class Finding { sound, damaged, unreadable };

  [[nodiscard]] base::Expected<bool> step(); // false: at the end
  [[nodiscard]] Finding take(Opcode opcode, const std::string& content);
  [[nodiscard]] Finding take_loose_message(std::string_view content);
  [[nodiscard]] Finding take_definition(Opcode opcode, std::string_view content);
  [[nodiscard]] Finding take_chunk(const std::string& content);
  void take_records(std::string_view records);
  void take_channel(Channel channel, bool has_crc);
  void take_message(std::string_view content, std::uint64_t position);
  void check_schema(const Channel& channel);
  [[nodiscard]] base::Expected<void> take_end(std::uint32_t crc, std::uint64_t begin);
  [[nodiscard]] base::Expected<void> go_on_behind(std::uint64_t offset);
  // Fails (interrupted) if a stop was requested.
  [[nodiscard]] base::Expected<void> walk_to(std::uint64_t offset) const;
  void damage(std::uint64_t offset, std::uint64_t bytes, std::string what);

  const RecordingReader& reader_;
  const ScanEvents& events_;
  ChunkSearch chunks_;
  ScanReport report_;
  std::uint64_t offset_ = 0;         // of the record that is read
  std::optional<std::uint32_t> crc_; // of everything before it; nothing: not known
  std::map<std::uint16_t, Schema> schemas_;
  struct KnownChannel {
    Channel channel;
    bool has_crc = false; // it stood in a chunk
  };
  std::map<std::uint16_t, KnownChannel> channels_;
  std::set<std::uint16_t> checked_; // channels whose schema was checked
};

} // namespace dyncal::inline records::recording
