#include "drivers/virtual_bench/wire/scpi_text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace dyncal::drivers::virtual_bench {

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

std::optional<double> parse_parameter(std::string_view text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

} // namespace dyncal::drivers::virtual_bench
