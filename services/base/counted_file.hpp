// A file that is read once from its beginning to its end, and counted meanwhile: for readers of
// JSON, which take a stream and tell nobody how far they are. Counted is what has been fetched from
// the file, 8 KB at a time; the bytes that a reader gets are those of std::ifstream. One thread.
#pragma once

#include <filesystem>
#include <fstream>
#include <istream>

#include "services/base/byte_count.hpp"

namespace dyncal::services {

class CountedFile {
public:
  // `count` outlives the object; several files add up in it.
  CountedFile(const std::filesystem::path& path, ByteCount& count)
      : buffer_(count), stream_(&buffer_) {
    if (buffer_.open(path, std::ios::in) == nullptr) {
      stream_.setstate(std::ios::failbit);
    }
  }

  // Failed from the beginning where the file cannot be opened.
  [[nodiscard]] std::istream& stream() { return stream_; }

private:
  class Buffer : public std::filebuf {
  public:
    explicit Buffer(ByteCount& count) : count_(count) {}

  protected:
    int_type underflow() override {
      const int_type next = std::filebuf::underflow();
      if (next != traits_type::eof()) {
        count_.add_done(static_cast<std::uint64_t>(egptr() - gptr()));
      }
      return next;
    }

  private:
    ByteCount& count_;
  };

  Buffer buffer_;
  std::istream stream_; // of the buffer
};

} // namespace dyncal::services
