#include "analysis/instrument/trigger_delay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "analysis/base/statistics.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

struct MeanAndScatter {
  double mean = 0.0;
  double scatter = 0.0;
};

template <class Value>
MeanAndScatter mean_and_scatter(std::span<const ShotDelay> shots, Value value) {
  MeanAndScatter result;
  for (const ShotDelay& shot : shots) {
    result.mean += value(shot) / static_cast<double>(shots.size());
  }
  double squares = 0.0;
  for (const ShotDelay& shot : shots) {
    squares += std::pow(value(shot) - result.mean, 2);
  }
  result.scatter = std::sqrt(squares / static_cast<double>(shots.size() - 1));
  return result;
}

} // namespace

Expected<double> rising_edge_s(double first_s, double interval_s, std::span<const double> volts) {
  if (volts.size() < 10 || !(interval_s > 0.0)) {
    return fail(ErrorCode::too_few_samples, "a trace of fewer than 10 samples shows no edge");
  }
  const std::vector<double> all(volts.begin(), volts.end());
  const double low = quantile_value(all, 0.02);
  const double high = quantile_value(all, 0.98);
  const double height = high - low;
  const auto no_edge = [] {
    return fail(ErrorCode::no_excitation, "the trace shows no rising edge");
  };
  // The last sample below 20 % before the first one above 80 %.
  const auto above =
      std::find_if(volts.begin(), volts.end(), [&](double v) { return v > low + 0.8 * height; });
  if (!(height > 0.0) || above == volts.end()) {
    return no_edge();
  }
  const auto place_above = static_cast<std::size_t>(above - volts.begin());
  std::size_t begin = place_above;
  while (begin > 0 && volts[begin] > low + 0.2 * height) {
    --begin;
  }
  if (begin == 0) {
    return no_edge();
  }
  const auto low_again =
      std::find_if(above, volts.end(), [&](double v) { return v < low + 0.2 * height; });
  if (std::any_of(low_again, volts.end(), [&](double v) { return v > low + 0.8 * height; })) {
    return fail(ErrorCode::no_excitation, "the trace shows more than one rising edge: which of "
                                          "them belongs to the trigger is unknown");
  }
  // Line through what lies between, both neighbours included when the edge is as steep as the
  // sampling.
  double n = 0.0;
  double sum_t = 0.0;
  double sum_v = 0.0;
  double sum_tt = 0.0;
  double sum_tv = 0.0;
  const bool steep = place_above - begin < 3;
  for (std::size_t i = begin; i <= place_above; ++i) {
    const bool between = volts[i] >= low + 0.2 * height && volts[i] <= low + 0.8 * height;
    if (!between && !steep) {
      continue;
    }
    const double t = static_cast<double>(i - begin);
    n += 1.0;
    sum_t += t;
    sum_v += volts[i];
    sum_tt += t * t;
    sum_tv += t * volts[i];
  }
  const double slope = (n * sum_tv - sum_t * sum_v) / (n * sum_tt - sum_t * sum_t);
  if (!(slope > 0.0) || !std::isfinite(slope)) {
    return no_edge();
  }
  const double half = low + 0.5 * height;
  const double from_begin = (half - (sum_v - slope * sum_t) / n) / slope;
  return first_s + (static_cast<double>(begin) + from_begin) * interval_s;
}

Expected<ShotDelay> delay_by_rectangle(const DelayTrace& trace) {
  const auto in = rising_edge_s(trace.first_s, trace.interval_s, trace.sync);
  if (!in) {
    return fail(in.error().code, "sync: " + in.error().message);
  }
  const auto out = rising_edge_s(trace.first_s, trace.interval_s, trace.output);
  if (!out) {
    return fail(out.error().code, "trigger output: " + out.error().message);
  }
  return ShotDelay{*out - *in, *out - *in};
}

Expected<ShotDelay> delay_by_sine(const DelayTrace& trace, const Frequency& frequency) {
  const auto out = rising_edge_s(trace.first_s, trace.interval_s, trace.output);
  if (!out) {
    return fail(out.error().code, "trigger output: " + out.error().message);
  }
  // Femtoseconds: oscilloscopes sample faster than whole nanoseconds can say. The frequency is in
  // turns per femtosecond times 1e9.
  std::vector<std::int64_t> stamps_fs(trace.sync.size());
  for (std::size_t i = 0; i < stamps_fs.size(); ++i) {
    stamps_fs[i] = std::llround((trace.first_s + static_cast<double>(i) * trace.interval_s) * 1e15);
  }
  const std::array channels{trace.sync};
  const auto fits = fit_sine(Frequency::from_hz(frequency.hz() * 1e-6), 0, stamps_fs, channels);
  if (!fits) {
    return fail(fits.error().code, "sync: " + fits.error().message);
  }
  const double zero_s = -fits->front().phase_rad() / (2.0 * std::numbers::pi * frequency.hz());
  return ShotDelay{*out, *out - zero_s};
}

Expected<TriggerDelay> mean_trigger_delay(std::span<const ShotDelay> shots, double interval_s) {
  if (shots.size() < 3) {
    return fail(ErrorCode::too_few_samples, "a trigger delay needs at least three shots");
  }
  const auto tau = [](const ShotDelay& shot) { return shot.output_delay_s; };
  const MeanAndScatter output = mean_and_scatter(shots, tau);
  const MeanAndScatter whole =
      mean_and_scatter(shots, [](const ShotDelay& shot) { return shot.from_zero_crossing_s; });
  TriggerDelay result;
  result.shots = shots.size();
  result.delay_s = output.mean;
  result.scatter_s = output.scatter;
  const double n = static_cast<double>(shots.size());
  const std::array parts{UncertaintyPart{output.scatter / std::sqrt(n), n - 1.0},
                         UncertaintyPart{interval_s / std::sqrt(12.0)}};
  result.of_delay = combine(parts);
  result.from_zero_crossing_s = whole.mean;
  result.scatter_from_zero_crossing_s = whole.scatter;
  const auto [least, most] = std::minmax_element(
      shots.begin(), shots.end(), [&](const auto& a, const auto& b) { return tau(a) < tau(b); });
  const auto bins =
      static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(shots.size()))));
  result.histogram.first_s = tau(*least);
  result.histogram.width_s =
      std::max((tau(*most) - tau(*least)) / static_cast<double>(bins), 1e-15);
  result.histogram.counts.resize(bins);
  for (const ShotDelay& shot : shots) {
    const auto bin =
        static_cast<std::size_t>((tau(shot) - result.histogram.first_s) / result.histogram.width_s);
    ++result.histogram.counts[std::min(bin, bins - 1)];
  }
  return result;
}

} // namespace dyncal::analysis
