// The number that a text is, all of it: no blanks, no sign "+", no unit. Any thread.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace dyncal::inline base {

// `format`: as std::from_chars() takes it, the base of a whole number. Nothing: it is no such
// number, or one beyond the type.
template <class Number, class... Format>
[[nodiscard]] std::optional<Number> parsed_number(std::string_view text, Format... format) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [read_to, status] = std::from_chars(text.data(), end, number, format...);
  return status == std::errc() && read_to == end ? std::optional(number) : std::nullopt;
}

} // namespace dyncal::inline base
