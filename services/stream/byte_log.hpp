// A file that bytes are appended to at one end and dropped at the other, bounded in size: what is
// too much for memory and need not outlive the process.
//
// The file has no name: it disappears with the process, however that ends. It grows by chunks of
// 1 MiB up to its bound, and chunks of which everything was dropped are used again, so that it is
// never longer than what was held at once. Offsets count all bytes ever appended.
//
// append() fails (bad_file) at the bound, when less than `min_free_bytes` would be left on the file
// system, and when the system refuses to write; what is held stays as it was. Blocks for as long as
// the disk does. One thread at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline stream {

class ByteLog {
public:
  static constexpr std::uint64_t chunk_bytes = std::uint64_t{1} << 20U;

  struct Limits {
    std::uint64_t bytes = std::uint64_t{1} << 30U;
    std::uint64_t min_free_bytes = 0; // of the file system
  };

  // Fails (bad_file) when there can be no file in the folder.
  [[nodiscard]] static Expected<ByteLog> create(const std::filesystem::path& folder, Limits limits);
  ByteLog(ByteLog&& other) noexcept;
  ByteLog& operator=(ByteLog&& other) = delete;
  ~ByteLog();

  // Returns the offset of the first of these bytes.
  [[nodiscard]] Expected<std::uint64_t> append(std::string_view bytes);
  // REQUIRES: all of them were appended, and none dropped.
  [[nodiscard]] Expected<std::string> read(std::uint64_t offset, std::size_t size) const;
  void drop_before(std::uint64_t offset);

  [[nodiscard]] std::uint64_t end() const { return end_; }
  [[nodiscard]] std::uint64_t file_bytes() const { return chunks_in_file_ * chunk_bytes; }

private:
  ByteLog(int file, std::filesystem::path folder, Limits limits)
      : file_(file), folder_(std::move(folder)), limits_(limits) {}
  [[nodiscard]] Expected<void> make_room(std::uint64_t end);
  // Calls `transfer(position in the file, first byte, bytes)` for each piece that lies in one
  // chunk.
  template <class Transfer>
  [[nodiscard]] bool for_each_piece(std::uint64_t offset, std::size_t size,
                                    Transfer&& transfer) const;

  int file_;
  std::filesystem::path folder_;
  Limits limits_;
  std::uint64_t first_chunk_ = 0;    // number, from 0, of the chunk that chunks_.front() holds
  std::deque<std::uint64_t> chunks_; // where in the file, in the order of offsets
  std::vector<std::uint64_t> free_;
  std::uint64_t chunks_in_file_ = 0;
  std::uint64_t end_ = 0;
};

// The folder for such files: that of the service under systemd ($CACHE_DIRECTORY,
// $STATE_DIRECTORY), else the one for temporary files.
[[nodiscard]] std::filesystem::path folder_for_kept_messages();

} // namespace dyncal::inline stream
