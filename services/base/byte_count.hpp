// The megabytes of files that are read, of a WorkCount (work_count.hpp): never backwards, and at
// the end as many as the total. Belongs to one thread; what it counts in is read from any.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "services/base/work_count.hpp"

namespace dyncal::inline base {

class ByteCount {
public:
  ByteCount() = default; // nobody wants to know

  // `total` bytes are read from now on; with 0, or less than a megabyte, only the time is shown.
  ByteCount(SharedWorkCount count, std::string what, std::uint64_t total)
      : count_(std::move(count)), total_(total) {
    if (count_) {
      count_->begin(std::move(what), "MB", megabytes(total));
    }
  }

  [[nodiscard]] std::uint64_t total() const { return total_; }
  [[nodiscard]] std::uint64_t done() const { return done_; }

  void set_done(std::uint64_t bytes) {
    bytes = std::min(bytes, total_);
    const bool shows = count_ && megabytes(bytes) > megabytes(done_);
    done_ = std::max(done_, bytes);
    if (shows) {
      count_->set_done(megabytes(done_));
    }
  }
  void add_done(std::uint64_t bytes) { set_done(done_ + bytes); }
  void set_share_done(double share) {
    set_done(static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(total_)));
  }

private:
  static std::size_t megabytes(std::uint64_t bytes) { return bytes / 1'000'000; }

  SharedWorkCount count_;
  std::uint64_t total_ = 0;
  std::uint64_t done_ = 0;
};

// 0 where nothing is known.
[[nodiscard]] inline std::uint64_t bytes_of_file(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::uintmax_t bytes = std::filesystem::file_size(path, unknown);
  return unknown ? 0 : bytes;
}
[[nodiscard]] inline std::uint64_t bytes_of_files(std::span<const std::filesystem::path> paths) {
  std::uint64_t bytes = 0;
  for (const std::filesystem::path& path : paths) {
    bytes += bytes_of_file(path);
  }
  return bytes;
}

} // namespace dyncal::inline base
