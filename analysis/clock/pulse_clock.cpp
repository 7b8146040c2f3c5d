#include "analysis/clock/pulse_clock.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double wander = 1e-8; // of a crystal within a minute
constexpr std::size_t others_that_moved = 3;
constexpr double tolerance_at_first_s = 1e-3;
constexpr double smallest_tolerance_s = 1e-7;
constexpr double smallest_tolerance_samples = 0.01;
constexpr double tolerance_in_u = 6.0;

double distance(const SampledPulse& from, const SampledPulse& to) {
  return static_cast<double>(static_cast<std::int64_t>(to.sample - from.sample)) +
         (to.part - from.part);
}

std::int64_t nearest_second(std::int64_t utc_ns) {
  return static_cast<std::int64_t>(std::llround(static_cast<long double>(utc_ns) * 1e-9L));
}

// Whole seconds of `seconds`, where it is one within the tolerance.
std::optional<std::int64_t> whole_seconds(double seconds, double tolerance_s) {
  const double whole = std::round(seconds);
  return whole >= 1.0 && std::abs(seconds - whole) <= tolerance_s
             ? std::optional(static_cast<std::int64_t>(whole))
             : std::nullopt;
}

} // namespace

PulseClock::Answer PulseClock::add(const SampledPulse& pulse, std::int64_t host_utc_ns) {
  const auto second =
      pulses_.empty() ? std::optional(nearest_second(host_utc_ns)) : second_of(pulse);
  if (!second) {
    return take_other(pulse, host_utc_ns);
  }
  others_.clear();
  pulses_.push_back({pulse, *second});
  if (pulses_.size() > pulses_of_line) {
    pulses_.pop_front();
  }
  if (pulses_.size() >= pulses_needed) {
    fit();
  }
  return Answer::taken;
}

std::optional<std::int64_t> PulseClock::second_of(const SampledPulse& pulse) const {
  const TimedPulse& newest = pulses_.back();
  double seconds = distance(newest.place, pulse) / samples_per_second_;
  double tolerance_s = tolerance_at_first_s;
  if (line_) {
    seconds = line_->offset_s + line_->s_per_sample * distance(newest.place, pulse);
    tolerance_s = std::max({tolerance_in_u * u_s(pulse.sample), smallest_tolerance_s,
                            smallest_tolerance_samples * line_->s_per_sample});
  }
  const auto whole = whole_seconds(seconds, tolerance_s);
  return whole ? std::optional(newest.second + *whole) : std::nullopt;
}

PulseClock::Answer PulseClock::take_other(const SampledPulse& pulse, std::int64_t host_utc_ns) {
  if (!others_.empty() &&
      !whole_seconds(distance(others_.back().first, pulse) / samples_per_second_,
                     tolerance_at_first_s)) {
    others_.clear();
  }
  others_.emplace_back(pulse, host_utc_ns);
  if (others_.size() < others_that_moved) {
    return Answer::left_out;
  }
  const auto others = std::move(others_);
  others_.clear();
  pulses_.clear();
  line_.reset();
  for (const auto& [place, utc_ns] : others) {
    add(place, utc_ns);
  }
  return Answer::moved;
}

void PulseClock::fit() {
  const TimedPulse& newest = pulses_.back();
  const double n = static_cast<double>(pulses_.size());
  double mean_x = 0.0, mean_y = 0.0;
  const auto x_of = [&](const TimedPulse& pulse) { return distance(newest.place, pulse.place); };
  const auto y_of = [&](const TimedPulse& pulse) {
    return static_cast<double>(pulse.second - newest.second);
  };
  for (const TimedPulse& pulse : pulses_) {
    mean_x += x_of(pulse) / n;
    mean_y += y_of(pulse) / n;
  }
  double xx = 0.0, xy = 0.0;
  Line line;
  for (const TimedPulse& pulse : pulses_) {
    xx += (x_of(pulse) - mean_x) * (x_of(pulse) - mean_x);
    xy += (x_of(pulse) - mean_x) * (y_of(pulse) - mean_y);
    line.shared_s = std::max(line.shared_s, pulse.place.u_samples);
  }
  line.s_per_sample = xy / xx;
  line.offset_s = mean_y - line.s_per_sample * mean_x;
  line.mean_samples = mean_x;
  line.spread_samples2 = xx;
  line.shared_s *= line.s_per_sample;
  double squares = 0.0;
  for (const TimedPulse& pulse : pulses_) {
    const double rest = y_of(pulse) - line.offset_s - line.s_per_sample * x_of(pulse);
    squares += rest * rest;
  }
  line.residual_s = std::sqrt(squares / (n - 2.0));
  line_ = line;
}

double PulseClock::samples_from_newest(std::uint64_t sample) const {
  return distance(pulses_.back().place, {.sample = sample});
}

std::int64_t PulseClock::utc_ns(std::uint64_t sample) const {
  const double after_s = line_->offset_s + line_->s_per_sample * samples_from_newest(sample);
  return pulses_.back().second * 1'000'000'000 + std::llround(after_s * 1e9);
}

double PulseClock::since_pulse_s(std::uint64_t sample) const {
  return line_->s_per_sample * samples_from_newest(sample);
}

double PulseClock::u_s(std::uint64_t sample) const {
  const double x = samples_from_newest(sample);
  const double from_mean = x - line_->mean_samples;
  const double of_line =
      line_->residual_s * std::sqrt(1.0 / static_cast<double>(pulses_.size()) +
                                    from_mean * from_mean / line_->spread_samples2);
  const double wandered_s = wander * std::max(0.0, x * line_->s_per_sample);
  return std::hypot(of_line, wandered_s, line_->shared_s);
}

} // namespace dyncal::analysis
