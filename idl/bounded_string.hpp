// The C++ of `string<64>` in the contract: text that is never longer than its bound, kept in place.
//
// Text beyond the bound is cut off, and so is what follows a zero byte: the wire has room for
// neither. Whoever takes a name from a user checks its length first (services/bus/names.hpp), for
// a name that was cut off may be that of somebody else. Plain data.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>

namespace dyncal::wire {

template <std::size_t bound>
class BoundedString {
public:
  BoundedString() = default;
  // Not explicit: members of a message are set from plain text.
  BoundedString(const char* text) { set(text != nullptr ? text : ""); } // NOLINT
  BoundedString(const std::string& text) { set(text.c_str()); }         // NOLINT
  template <std::size_t other>
  BoundedString(const BoundedString<other>& text) { // NOLINT
    set(text.c_str());
  }

  [[nodiscard]] const char* c_str() const { return text_.data(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::string to_string() const { return {text_.data(), size_}; }
  operator const char*() const { return c_str(); } // NOLINT: read like plain text

  template <std::size_t other>
  bool operator==(const BoundedString<other>& text) const {
    return view() == std::string_view(text.c_str(), text.size());
  }
  bool operator==(const char* text) const { return view() == text; }
  bool operator==(const std::string& text) const { return view() == text; }

private:
  [[nodiscard]] std::string_view view() const { return {text_.data(), size_}; }

  void set(std::string_view text) {
    size_ = std::min(bound, text.size());
    std::copy_n(text.data(), size_, text_.begin());
  }

  std::array<char, bound + 1> text_{}; // and the zero behind it
  std::size_t size_ = 0;
};

template <std::size_t bound>
std::ostream& operator<<(std::ostream& stream, const BoundedString<bound>& text) {
  return stream << text.c_str();
}

} // namespace dyncal::wire
