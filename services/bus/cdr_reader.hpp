// Reads members of a message from plain CDR (XCDR1) in either byte order; the layout stands in
// cdr_writer.hpp.
//
// Stops at the beginning of the first member that is not wholly there, or is no value of its type,
// and leaves the rest of the members as they are. Room for a sequence of structs is made element by
// element, so that a count that was changed on the way makes no more room than its message holds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "idl/bounded_string.hpp"
#include "services/bus/cdr_key.hpp"

namespace dyncal::bus {

class CdrReader {
public:
  // REQUIRES: at least a header.
  CdrReader(const char* bytes, std::size_t count)
      : payload_(bytes + cdr_header_bytes), count_(count - cdr_header_bytes), swap_(bytes[1] == 0),
        is_whole_(bytes[0] == 0 && (bytes[1] == 0 || bytes[1] == 1)) {}

  // Of the whole payload, with its header, before the first member that could not be read.
  [[nodiscard]] std::size_t size() const { return cdr_header_bytes + position_; }
  [[nodiscard]] bool is_whole() const { return is_whole_; }

  template <class T>
  void operator()(T& member) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      take(&member, sizeof member, 1);
    } else {
      T::visit_members(member, *this);
    }
  }
  void operator()(bool& member) {
    const std::size_t begin = position_;
    std::uint8_t value = 0;
    (*this)(value);
    member = value == 1;
    stop_unless(value <= 1, begin);
  }
  template <std::size_t bound>
  void operator()(wire::BoundedString<bound>& text) {
    const std::string_view whole = take_text();
    if (is_closed(whole)) {
      text = whole.data();
    } else {
      text = std::string(whole);
    }
  }
  void operator()(std::string& text) {
    const std::string_view whole = take_text();
    text = whole.substr(0, whole.size() - (is_closed(whole) ? 1 : 0));
  }
  template <class T>
  void operator()(std::vector<T>& elements) {
    const std::size_t begin = position_;
    std::uint32_t count = 0;
    (*this)(count);
    if (!stop_unless(count <= count_ - position_, begin) || count == 0) {
      elements.clear();
      return;
    }
    if constexpr (std::is_arithmetic_v<T>) {
      if (stop_unless(count <= (count_ - position_) / sizeof(T), begin)) {
        elements.resize(count);
        take(elements.data(), sizeof(T), count);
      }
    } else {
      elements.resize(std::min<std::size_t>(count, elements.size()));
      for (std::uint32_t i = 0; i < count && is_whole_; ++i) {
        (*this)(i < elements.size() ? elements[i] : elements.emplace_back());
      }
    }
    stop_unless(is_whole_, begin);
  }

private:
  static bool is_closed(std::string_view text) { return !text.empty() && text.back() == '\0'; }

  // With its closing zero.
  std::string_view take_text() {
    const std::size_t begin = position_;
    std::uint32_t count = 0;
    (*this)(count);
    if (!stop_unless(count <= count_ - position_, begin)) {
      return {};
    }
    position_ += count;
    return {payload_ + position_ - count, count};
  }

  bool stop_unless(bool is_right, std::size_t begin) {
    if (!is_right || !is_whole_) {
      is_whole_ = false;
      position_ = begin;
    }
    return is_whole_;
  }

  void take(void* to, std::size_t size, std::size_t count) {
    const std::size_t begin = (position_ + size - 1) & ~(size - 1);
    if (!is_whole_ || begin > count_ || count > (count_ - begin) / size) {
      is_whole_ = false;
      return;
    }
    std::memcpy(to, payload_ + begin, count * size);
    position_ = begin + count * size;
    if (swap_) {
      auto* bytes = static_cast<char*>(to);
      for (std::size_t i = 0; i < count; ++i) {
        std::reverse(bytes + i * size, bytes + (i + 1) * size);
      }
    }
  }

  const char* payload_;
  std::size_t count_;
  bool swap_;
  bool is_whole_; // so far
  std::size_t position_ = 0;
};

} // namespace dyncal::bus
