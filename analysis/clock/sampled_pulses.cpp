#include "analysis/clock/sampled_pulses.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t edge_samples = 16; // on either side
constexpr std::size_t level_samples = 32;
constexpr std::size_t reach = edge_samples + level_samples;
constexpr double smallest_step = 0.25;   // of the largest
constexpr double largest_wander = 0.01;  // of a level, in parts of the step
constexpr double quietest_filter = 0.01; // of the step: what a filter leaves beside the edge

struct Level {
  double mean = 0.0;
  double wander = 0.0; // second half against the first
  double noise = 0.0;
};

Level level_of(std::span<const double> values) {
  const auto mean_of = [](std::span<const double> part) {
    double sum = 0.0;
    for (const double value : part) {
      sum += value;
    }
    return sum / static_cast<double>(part.size());
  };
  const std::size_t half = values.size() / 2;
  Level level{.mean = mean_of(values),
              .wander = mean_of(values.subspan(half)) - mean_of(values.first(half)),
              .noise = 0.0};
  for (const double value : values) {
    level.noise += (value - level.mean) * (value - level.mean);
  }
  level.noise = std::sqrt(level.noise / static_cast<double>(values.size()));
  return level;
}

// Beside the two samples about the edge: largest deviation from the level of its side.
double ringing_of(std::span<const double> edge, double low, double high) {
  double ringing = 0.0;
  for (std::size_t i = 0; i < edge.size(); ++i) {
    if (i + 1 < edge_samples) {
      ringing = std::max(ringing, std::abs(edge[i] - low));
    } else if (i > edge_samples) {
      ringing = std::max(ringing, std::abs(edge[i] - high));
    }
  }
  return ringing;
}

} // namespace

SampledPulses::SampledPulses(double samples_per_second, Edge edge)
    : learnt_samples_(static_cast<std::size_t>(1.25 * samples_per_second)),
      sign_(edge == Edge::rising ? 1.0 : -1.0) {}

std::vector<SampledPulse> SampledPulses::push(std::span<const double> values) {
  for (const double value : values) {
    kept_.push_back(sign_ * value);
  }
  std::vector<SampledPulse> pulses;
  if (!knows_levels_) {
    if (kept_.size() < learnt_samples_) {
      return pulses;
    }
    learn_levels();
  }
  find(pulses);
  if (searched_ > reach) {
    const std::size_t done = searched_ - reach;
    kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(done));
    first_ += done;
    searched_ = reach;
  }
  return pulses;
}

void SampledPulses::restart(std::uint64_t sample) {
  kept_.clear();
  first_ = sample;
  searched_ = 0;
  knows_levels_ = false;
}

void SampledPulses::learn_levels() {
  const auto [low, high] = std::minmax_element(kept_.begin(), kept_.end());
  low_ = *low;
  high_ = *high;
  is_high_ = kept_.front() > 0.5 * (low_ + high_);
  knows_levels_ = true;
}

void SampledPulses::find(std::vector<SampledPulse>& pulses) {
  const double middle = 0.5 * (low_ + high_);
  const double margin = 0.25 * (high_ - low_);
  for (; searched_ + reach < kept_.size(); ++searched_) {
    const double value = kept_[searched_];
    if (is_high_) {
      is_high_ = value > middle - margin;
    } else if (value > middle + margin) {
      is_high_ = true;
      if (searched_ >= reach) {
        take(searched_, pulses);
      }
    }
  }
}

void SampledPulses::take(std::size_t crossing, std::vector<SampledPulse>& pulses) {
  const std::span<const double> all = kept_;
  // The first sample behind the middle, which may be before that beyond the margin.
  const double middle = 0.5 * (low_ + high_);
  while (kept_[crossing - 1] > middle && crossing > reach) {
    --crossing;
  }
  const std::size_t begin = crossing - edge_samples;
  const Level low = level_of(all.subspan(begin - level_samples, level_samples));
  const Level high = level_of(all.subspan(crossing + edge_samples, level_samples));
  const double step = high.mean - low.mean;
  if (step < smallest_step * (high_ - low_)) {
    return;
  }
  if (std::max(std::abs(low.wander), std::abs(high.wander)) > largest_wander * step) {
    ++restless_;
    return;
  }
  const std::span<const double> edge = all.subspan(begin, 2 * edge_samples);
  double before = 0.0;
  for (const double value : edge) {
    before += (high.mean - value) / step;
  }
  const double from_crossing = before - static_cast<double>(edge_samples) - 0.5;
  const double whole = std::floor(from_crossing);
  const double quiet = quietest_filter * step + 4.0 * std::max(low.noise, high.noise);
  const bool unfiltered = ringing_of(edge, low.mean, high.mean) < quiet;
  pulses.push_back(
      {.sample = first_ + crossing + static_cast<std::uint64_t>(static_cast<std::int64_t>(whole)),
       .part = from_crossing - whole,
       .u_samples = unfiltered ? 1.0 / std::sqrt(12.0) : 0.0});
}

} // namespace dyncal::analysis
