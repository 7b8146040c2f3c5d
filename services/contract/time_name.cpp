#include "services/contract/time_name.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <string_view>

#include <fmt/core.h>

namespace dyncal::inline contract {

std::string time_name(std::int64_t utc_ns) {
  const std::int64_t now_ms = utc_ns / 1'000'000;
  const auto seconds = static_cast<std::time_t>(now_ms / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%S", &utc);
  return fmt::format("{}.{:03}Z", std::string(text.data(), length), now_ms % 1000);
}

bool is_time_name(const std::string& name) {
  constexpr std::string_view form = "ddddddddTdddddd.dddZ"; // d: a digit
  return std::equal(name.begin(), name.end(), form.begin(), form.end(),
                    [](char c, char f) { return f == 'd' ? c >= '0' && c <= '9' : c == f; });
}

} // namespace dyncal::inline contract
