// Reads an MCAP recording from its beginning to its end, whatever has happened to the file.
//
// Nothing is handed over that its CRC denies: messages of chunks, attachments. Every
// length is held against the file before memory is taken. A chunk whose CRC is wrong is left out
// and the reader goes on behind it; where a length is wrong it goes on with the next chunk that is
// whole. Each of these is a Damage with place and sentence. A recording whose program was killed
// has no damage: it is whole to its last flush, and `ended_in_order` is false. What the CRC of all
// the data, of the summary or of metadata does not vouch for is a Damage too, with the records
// there.
//
// open() fails (bad_file) when the file cannot be read or is no MCAP file, scan() when reading
// fails. Foreign chunks without a CRC, and messages of a file without chunks, which have none, are
// read, and counted. Chunks of a compression that this build does not know are named. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/error.hpp"
#include "services/records/mcap/mcap_record.hpp"

namespace dyncal::inline records::recording {

struct Damage {
  std::uint64_t offset = 0; // in the file
  std::uint64_t bytes = 0;
  std::string what;
};

// "FILE: at byte 1234 (56 bytes): ..."
[[nodiscard]] std::string to_string(const Damage& damage, const std::filesystem::path& path);

// The views last until the call returns.
struct MessageInFile {
  const Channel& channel;
  const Schema* schema = nullptr; // null: the channel has none, or it was lost
  Message message;
  std::uint64_t chunk = 0;    // offset of its chunk in the file, or of itself outside chunks
  std::uint64_t position = 0; // of its record in the chunk's records
};

struct ScanEvents { // any may be empty
  std::function<void(const MessageInFile&)> message{};
  std::function<void(const Attachment&)> attachment{};
  std::function<void(const Metadata&)> metadata{};
  // So many bytes of the file are behind: never fewer than before, all of them at the end. False:
  // stop, and fail (interrupted).
  std::function<bool(std::uint64_t)> walked{};
};

struct ScanReport {
  static constexpr std::size_t max_damages = 1000; // that are kept; more are counted

  std::string library; // that wrote the file
  std::uint64_t file_bytes = 0;
  std::uint64_t messages = 0;
  std::uint64_t chunks = 0;
  std::uint64_t unchecked_chunks = 0; // without a CRC
  std::uint64_t loose_messages = 0;   // outside chunks, without a CRC
  std::uint64_t lost_chunks = 0;      // of the damages
  std::uint64_t unknown_chunks = 0; // of the damages: sound perhaps, their compression is not known
  std::uint64_t damage_count = 0;
  std::vector<Damage> damages;
  bool ended_in_order = false; // has a sound summary
};

class RecordingReader {
public:
  [[nodiscard]] static base::Expected<RecordingReader> open(const std::filesystem::path& path);
  // Of a file that is open; `name` is for messages.
  [[nodiscard]] static base::Expected<RecordingReader> read(drivers::FileDescriptor file,
                                                            std::filesystem::path name);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::uint64_t size_bytes() const { return size_; }
  [[nodiscard]] base::Expected<ScanReport> scan(const ScanEvents& events);
  // The records of the chunk at this offset, with the CRC checked, or the message outside chunks
  // that is there. Fails (bad_file) with a part of a sentence: what is wrong with it.
  [[nodiscard]] base::Expected<std::string> chunk_records(std::uint64_t offset) const;

  // Exactly these, which the file has. Fails (bad_file) when they cannot be read.
  [[nodiscard]] base::Expected<std::string> bytes(std::uint64_t offset, std::uint64_t count) const;

private:
  RecordingReader(std::filesystem::path path, drivers::FileDescriptor file, std::uint64_t size)
      : path_(std::move(path)), file_(std::move(file)), size_(size) {}

  std::filesystem::path path_;
  drivers::FileDescriptor file_;
  std::uint64_t size_ = 0;
};

} // namespace dyncal::inline records::recording
