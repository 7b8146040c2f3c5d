// Reads the metadata of a TDMS file from one place on, in the byte order of its segment.
//
// What would lie beyond the end is 0 or "", and from then on the cursor has failed: whoever reads a
// list asks that in every turn, so that no count of a damaged file is believed. One thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace dyncal::drivers::files {

// REQUIRES: sizeof(Number) bytes at `from`
template <class Number>
Number tdms_number_at(const char* from, bool big_endian) {
  std::array<char, sizeof(Number)> bytes{};
  std::memcpy(bytes.data(), from, bytes.size());
  if (big_endian) {
    std::reverse(bytes.begin(), bytes.end());
  }
  Number number{};
  std::memcpy(&number, bytes.data(), bytes.size());
  return number;
}

class TdmsCursor {
public:
  // REQUIRES: place <= end <= file.size()
  TdmsCursor(std::string_view file, std::size_t place, std::size_t end, bool big_endian)
      : file_(file), place_(place), end_(end), big_endian_(big_endian) {}

  template <class Number>
  Number number() {
    const char* const from = take(sizeof(Number));
    return from == nullptr ? Number{} : tdms_number_at<Number>(from, big_endian_);
  }
  std::string text() {
    const auto length = number<std::uint32_t>();
    const char* const from = take(length);
    return from == nullptr ? std::string() : std::string(from, length);
  }
  void skip(std::size_t bytes) { static_cast<void>(take(bytes)); }

  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] bool big_endian() const { return big_endian_; }
  [[nodiscard]] std::size_t place() const { return place_; }

private:
  const char* take(std::size_t bytes) {
    if (failed_ || bytes > end_ - place_) {
      failed_ = true;
      return nullptr;
    }
    const char* const from = file_.data() + place_;
    place_ += bytes;
    return from;
  }

  std::string_view file_;
  std::size_t place_;
  std::size_t end_;
  bool big_endian_;
  bool failed_ = false;
};

} // namespace dyncal::drivers::files
