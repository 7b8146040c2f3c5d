#include "services/run/level_reading.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <fmt/core.h>

namespace dyncal::inline run {
namespace {

constexpr double max_part_at_range = 5e-4; // as a result is flagged (signal_integrity.hpp)

std::span<const double> samples_in(const SourceRecord& record, std::size_t channel,
                                   const TimeInterval& window) {
  const auto stamps = record.stamps_ns();
  const auto values = record.column(channel);
  if (values.size() != stamps.size()) {
    return {};
  }
  const auto begin = std::lower_bound(stamps.begin(), stamps.end(), window.begin_ns);
  const auto end = std::upper_bound(begin, stamps.end(), window.end_ns);
  return values.subspan(static_cast<std::size_t>(begin - stamps.begin()),
                        static_cast<std::size_t>(end - begin));
}

double part_at_range(const drivers::ChannelDescription& channel, std::span<const double> values) {
  if (values.empty() || !(channel.maximum > channel.minimum)) {
    return 0.0;
  }
  const double half = 0.5 * channel.resolution;
  const auto at_range = std::count_if(values.begin(), values.end(), [&](double value) {
    return value <= channel.minimum + half || value >= channel.maximum - half;
  });
  return static_cast<double>(at_range) / static_cast<double>(values.size());
}

double standard_deviation(std::span<const double> values) {
  double mean = 0.0;
  for (const double value : values) {
    mean += value / static_cast<double>(values.size());
  }
  double sum = 0.0;
  for (const double value : values) {
    sum += (value - mean) * (value - mean);
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

} // namespace

Expected<void> check_range(const SourceRecord& record, std::size_t channel,
                           const TimeInterval& window) {
  const drivers::ChannelDescription& described = record.description().channels[channel];
  const double part = part_at_range(described, samples_in(record, channel, window));
  if (part > max_part_at_range) {
    return fail(ErrorCode::device,
                fmt::format("{}/{} is at an end of its range in {:.2g} % of its samples, so that "
                            "it shows less than there is; choose a wider range, or a lower level",
                            record.source(), described.name, 100.0 * part));
  }
  return {};
}

Expected<LevelReading> read_level(const SourceRecord& record, std::size_t channel,
                                  const TimeInterval& window, const analysis::Frequency& frequency,
                                  double agreement_rel) {
  DYNCAL_TRY(check_range(record, channel, window));
  const std::vector<double> values = part_of(record, channel, window, frequency).values;
  const std::int64_t middle_ns = window.begin_ns + (window.end_ns - window.begin_ns) / 2;
  const auto sine = sine_in(record, channel, window, frequency);
  const auto level = sine ? std::optional(sine->amplitude) : std::nullopt;
  const double all_rms = standard_deviation(values);
  const double sine_rms = level.value_or(0.0) / std::numbers::sqrt2;
  if (!values.empty() && (!level || all_rms * all_rms > 2.0 * sine_rms * sine_rms)) {
    return LevelReading{
        .lacking = fmt::format("of {:.3g} m/s^2 rms that it shows, {:.3g} are at {:.6g} Hz: does "
                               "it hum, or is the exciter off?",
                               all_rms, sine_rms, frequency.hz())};
  }
  const auto first = level_in(record, channel, {window.begin_ns, middle_ns - 1}, frequency);
  const auto second = level_in(record, channel, {middle_ns, window.end_ns}, frequency);
  if (!level || !first || !second || std::abs(*second - *first) > agreement_rel * *level) {
    return LevelReading{.lacking = "is settling_s long enough?"};
  }
  return LevelReading{.level_m_s2 = level, .sine = *sine};
}

} // namespace dyncal::inline run
