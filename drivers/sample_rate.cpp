#include "drivers/sample_rate.hpp"

#include <charconv>
#include <cmath>
#include <numeric>
#include <string_view>

namespace dyncal::drivers {

std::optional<SampleRate> sample_rate_from_hz(double hz) {
  if (!(hz >= 1e-6 && hz <= 1e9)) {
    return std::nullopt;
  }
  char text[64];
  const auto [end, status] = std::to_chars(text, text + sizeof(text), hz, std::chars_format::fixed);
  if (status != std::errc()) {
    return std::nullopt;
  }
  SampleRate rate;
  bool decimals = false;
  for (const char digit : std::string_view(text, end)) {
    if (digit == '.') {
      decimals = true;
      continue;
    }
    if (decimals && rate.denominator == 1'000'000'000) {
      return std::nullopt;
    }
    rate.numerator = rate.numerator * 10 + (digit - '0');
    rate.denominator *= decimals ? 10 : 1;
  }
  const std::int64_t common = std::gcd(rate.numerator, rate.denominator);
  return SampleRate{rate.numerator / common, rate.denominator / common};
}

} // namespace dyncal::drivers
