#include "drivers/files/tdms/tdms_clock.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>

namespace dyncal::drivers::files {
namespace {

constexpr double near_whole = 1e-9; // relative

std::int64_t power_of_ten(int exponent) {
  std::int64_t power = 1;
  for (int i = 0; i < exponent; ++i) {
    power *= 10;
  }
  return power;
}

} // namespace

std::optional<RegularClock> tdms_interval(double increment_s) {
  if (!(increment_s >= 1e-9 && increment_s <= 1e6)) {
    return std::nullopt;
  }
  const double rate_hz = 1.0 / increment_s;
  const double whole = std::round(rate_hz);
  if (whole >= 1.0 && std::abs(rate_hz - whole) <= near_whole * whole) {
    return RegularClock{0, tdms_second_ns, static_cast<std::int64_t>(whole)};
  }
  char text[32]; // d.ddde-05
  const char* const end =
      std::to_chars(text, text + sizeof(text), increment_s, std::chars_format::scientific).ptr;
  const std::string_view all(text, static_cast<std::size_t>(end - text));
  const std::size_t mantissa_end = all.find('e');
  const std::size_t sign = all[mantissa_end + 1] == '+' ? 1 : 0; // which from_chars() does not take
  int exponent = 0;
  std::from_chars(text + mantissa_end + 1 + sign, end, exponent);
  exponent += 9; // of nanoseconds
  std::int64_t digits = 0;
  for (std::size_t i = 0; i < mantissa_end; ++i) {
    if (all[i] != '.') {
      digits = digits * 10 + (all[i] - '0');
      exponent -= i > 1 ? 1 : 0;
    }
  }
  const std::int64_t numerator = exponent > 0 ? digits * power_of_ten(exponent) : digits;
  const std::int64_t denominator = exponent < 0 ? power_of_ten(-exponent) : 1;
  const std::int64_t common = std::gcd(numerator, denominator);
  return RegularClock{0, numerator / common, denominator / common};
}

std::optional<std::int64_t> tdms_start_ns(const TdmsProperties& channel) {
  const auto found = channel.find("wf_start_time");
  const auto* start = found == channel.end() ? nullptr : std::get_if<TdmsTime>(&found->second);
  const double offset_ns = number_in(channel, "wf_start_offset").value_or(0.0) * 1e9;
  std::int64_t start_ns = 0;
  if (start == nullptr && offset_ns == 0.0) {
    return std::nullopt;
  }
  const std::int64_t time_ns = start == nullptr ? 0 : start->unix_ns;
  const bool is_small = std::abs(offset_ns) < 9e18;
  return is_small && !__builtin_add_overflow(time_ns, std::llround(offset_ns), &start_ns)
             ? std::optional(start_ns)
             : std::nullopt;
}

bool holds_stamps(const RegularClock& clock, std::uint64_t samples) {
  __extension__ using Wide = __int128;
  const Wide span = static_cast<Wide>(samples) * clock.interval_numerator_ns;
  return clock.origin_ns + span / clock.interval_denominator + 1 <
         static_cast<Wide>(std::numeric_limits<std::int64_t>::max());
}

} // namespace dyncal::drivers::files
