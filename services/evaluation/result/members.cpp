#include "services/evaluation/result/members.hpp"

#include <array>
#include <cstdlib>
#include <ctime>

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr const char* whole_seconds = "%Y-%m-%dT%H:%M:%S";

} // namespace

const char* to_string(drivers::TimeBase base) {
  return base == drivers::TimeBase::utc ? "utc" : "local";
}

const char* to_string(drivers::StampInstant instant) {
  return per_enumerator(instant, {"unknown", "data_ready_edge", "conversion", "trigger_edge",
                                  "frame_start", "frame_end"});
}

std::string utc_text(std::int64_t utc_ns) {
  if (utc_ns == 0) {
    return "";
  }
  const std::int64_t fraction_ns = ((utc_ns % second_ns) + second_ns) % second_ns;
  const std::time_t seconds = (utc_ns - fraction_ns) / second_ns;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), whole_seconds, &utc);
  return fmt::format("{}.{:09}Z", text.data(), fraction_ns);
}

std::int64_t parse_utc_text(const std::string& text) {
  std::tm utc{};
  const char* rest = strptime(text.c_str(), whole_seconds, &utc);
  if (rest == nullptr) {
    return 0;
  }
  const std::int64_t fraction_ns = *rest == '.' ? std::strtoll(rest + 1, nullptr, 10) : 0;
  return std::int64_t{timegm(&utc)} * second_ns + fraction_ns;
}

std::optional<TemperatureRange> temperature_range(const analysis::SampleClockStatistics& clock) {
  double sum = 0.0;
  double count = 0.0;
  for (const analysis::TemperatureBin& bin : clock.over_temperature) {
    sum += bin.temperature_degc * static_cast<double>(bin.count);
    count += static_cast<double>(bin.count);
  }
  if (count == 0.0) {
    return std::nullopt;
  }
  return TemperatureRange{clock.over_temperature.front().temperature_degc, sum / count,
                          clock.over_temperature.back().temperature_degc};
}

} // namespace dyncal::inline evaluation
