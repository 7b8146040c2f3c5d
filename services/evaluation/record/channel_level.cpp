#include "services/evaluation/record/channel_level.hpp"

#include <algorithm>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr std::size_t min_samples = 16;
constexpr double min_window_s = 0.2;
constexpr double window_periods = 4.0;

} // namespace

double level_window_s(double frequency_hz) {
  return std::max(min_window_s, window_periods / frequency_hz);
}

std::optional<SineOfPart> sine_in(const SourceRecord& record, std::size_t channel,
                                  const TimeInterval& interval,
                                  const analysis::Frequency& frequency) {
  const auto stamps = record.stamps_ns();
  const auto values = record.column(channel);
  const auto begin = std::lower_bound(stamps.begin(), stamps.end(), interval.begin_ns);
  const auto end = std::upper_bound(begin, stamps.end(), interval.end_ns);
  const auto first = static_cast<std::size_t>(begin - stamps.begin());
  const auto count = static_cast<std::size_t>(end - begin);
  if (count < min_samples || values.size() != stamps.size()) {
    return std::nullopt;
  }
  const auto part = values.subspan(first, count);
  const auto fit =
      analysis::fit_sine(frequency, *begin, stamps.subspan(first, count), std::span(&part, 1));
  return fit ? std::optional(SineOfPart{fit->front().amplitude(), fit->front().phase_rad(), *begin})
             : std::nullopt;
}

std::optional<double> level_in(const SourceRecord& record, std::size_t channel,
                               const TimeInterval& interval, const analysis::Frequency& frequency) {
  const auto sine = sine_in(record, channel, interval, frequency);
  return sine ? std::optional(sine->amplitude) : std::nullopt;
}

} // namespace dyncal::inline evaluation
