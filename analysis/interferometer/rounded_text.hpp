// A number as a sentence for people shows it. Pure function; any thread.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace dyncal::analysis {

[[nodiscard]] inline std::string rounded_text(double value, int significant_digits) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                 std::chars_format::general, significant_digits);
  return {text.data(), end.ptr};
}

} // namespace dyncal::analysis
