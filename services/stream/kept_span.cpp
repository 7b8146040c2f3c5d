#include "services/stream/kept_span.hpp"

#include <fmt/core.h>

namespace dyncal::inline stream {
namespace {

constexpr double value_bytes = 8.0;
constexpr double stamp_bytes = 13.0; // stamp, uncertainty, flags
constexpr double megabyte = 1e6;

} // namespace

std::optional<KeptSpan> kept_span(SourceKind kind, const drivers::SourceDescription& source,
                                  const KeptLimits& limits) {
  const auto channels = static_cast<double>(source.channels.size());
  const double sample_bytes =
      channels * value_bytes + (kind == SourceKind::acs ? 0.0 : stamp_bytes);
  const double rate = source.nominal_rate_hz * sample_bytes;
  if (is_triggered(kind) || channels == 0.0 || !(rate > 0.0)) {
    return std::nullopt;
  }
  const auto bytes = static_cast<double>(limits.file_bytes);
  const double promised = std::chrono::duration<double, std::ratio<60>>(limits.span).count();
  KeptSpan span;
  span.minutes = bytes / rate / 60.0;
  span.is_short = span.minutes < promised;
  span.sentence = fmt::format(
      "keeps up to {:.1f} min of a run for who catches up: {:.0f} MB at {:.2f} MB/s ({} channels "
      "at {:g} Hz)",
      span.minutes, bytes / megabyte, rate / megabyte, source.channels.size(),
      source.nominal_rate_hz);
  if (span.is_short) {
    span.sentence += fmt::format("; that is less than {:.0f} min: an analysis that is away for "
                                 "longer loses samples, and a run that began before cannot be "
                                 "taken over; where that matters, lower the rate",
                                 promised);
  }
  return span;
}

} // namespace dyncal::inline stream
