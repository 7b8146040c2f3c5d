#include "services/evaluation/record/channel_level.hpp"

#include <algorithm>

#include "analysis/interferometer/reference_motion.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "services/contract/excitation_quantity.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr std::size_t min_samples = 16;
constexpr double min_window_s = 0.2;
constexpr double window_periods = 4.0;

} // namespace

double level_window_s(double frequency_hz) {
  return std::max(min_window_s, window_periods / frequency_hz);
}

ChannelPart part_of(const SourceRecord& record, std::size_t channel, const TimeInterval& interval,
                    const analysis::Frequency& frequency) {
  const auto stamps = record.stamps_ns();
  const auto values = record.column(channel);
  if (values.size() != stamps.size()) {
    return {};
  }
  const auto begin = std::lower_bound(stamps.begin(), stamps.end(), interval.begin_ns);
  const auto end = std::upper_bound(begin, stamps.end(), interval.end_ns);
  const auto first = static_cast<std::size_t>(begin - stamps.begin());
  const auto count = static_cast<std::size_t>(end - begin);
  ChannelPart part{stamps.subspan(first, count), {}};
  const auto samples = values.subspan(first, count);
  if (!record.described() ||
      quadrature_signals_of(record.description(), record.description().channels[channel].name) ==
          nullptr) {
    part.values.assign(samples.begin(), samples.end());
    return part;
  }
  part.values = analysis::without_slow_motion(frequency.hz(), part.stamps_ns, samples);
  for (double& value : part.values) {
    value *= -frequency.angular() * frequency.angular();
  }
  return part;
}

std::optional<SineOfPart> sine_in(const SourceRecord& record, std::size_t channel,
                                  const TimeInterval& interval,
                                  const analysis::Frequency& frequency) {
  const ChannelPart part = part_of(record, channel, interval, frequency);
  if (part.values.size() < min_samples) {
    return std::nullopt;
  }
  const std::int64_t begin_ns = part.stamps_ns.front();
  const std::span<const double> values(part.values);
  const auto fit = analysis::fit_sine(frequency, begin_ns, part.stamps_ns, std::span(&values, 1));
  return fit ? std::optional(
                   SineOfPart{fit->front().amplitude(), fit->front().phase_rad(), begin_ns})
             : std::nullopt;
}

std::optional<double> level_in(const SourceRecord& record, std::size_t channel,
                               const TimeInterval& interval, const analysis::Frequency& frequency) {
  const auto sine = sine_in(record, channel, interval, frequency);
  return sine ? std::optional(sine->amplitude) : std::nullopt;
}

} // namespace dyncal::inline evaluation
