#include "analysis/clock/period_count.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t first_samples = 65;
constexpr double periods_among_first = 0.9;
constexpr double margin_periods = 0.25;
constexpr double max_drift_rel = 1e-4; // of the period in what is missing
constexpr double max_unnumbered = 1000.0;
constexpr std::uint32_t max_passed_over = 8;

bool is_multiple(double distance_ns, double period_ns) {
  const double times = std::round(distance_ns / period_ns);
  return times >= 1.0 && std::abs(distance_ns - times * period_ns) <= margin_periods * period_ns;
}

} // namespace

void PeriodCount::add(std::uint64_t sample, std::int64_t stamp_ns) {
  const Sample one{sample, stamp_ns, std::exchange(begins_stretch_, false)};
  if (learned_) {
    count(one);
    return;
  }
  first_.push_back(one);
  if (first_.size() == first_samples) {
    learn();
  }
}

void PeriodCount::restart() {
  begins_stretch_ = true;
}

void PeriodCount::finish() {
  if (!learned_) {
    learn();
  }
}

void PeriodCount::learn() {
  learned_ = true;
  std::vector<double> intervals_ns;
  for (std::size_t i = 1; i < first_.size(); ++i) {
    if (!first_[i].begins_stretch && first_[i].number == first_[i - 1].number + 1) {
      intervals_ns.push_back(static_cast<double>(first_[i].stamp_ns - first_[i - 1].stamp_ns));
    }
  }
  if (!intervals_ns.empty()) {
    const double usual_ns = upper_median(intervals_ns);
    const auto whole = std::count_if(intervals_ns.begin(), intervals_ns.end(), [&](double one_ns) {
      return usual_ns > 0.0 && is_multiple(one_ns, usual_ns);
    });
    if (static_cast<double>(whole) >=
        periods_among_first * static_cast<double>(intervals_ns.size())) {
      period_ns_ = usual_ns;
    }
  }
  for (const Sample& sample : std::exchange(first_, {})) {
    count(sample);
  }
}

std::optional<std::uint64_t> PeriodCount::periods_in(std::int64_t distance_ns,
                                                     std::uint64_t numbered) const {
  const auto distance = static_cast<double>(distance_ns);
  const auto times = static_cast<double>(numbered);
  if (std::abs(distance - times * period_ns_) <=
      (margin_periods + max_drift_rel * times) * period_ns_) {
    return numbered;
  }
  if (is_multiple(distance, period_ns_) && distance <= max_unnumbered * period_ns_) {
    return static_cast<std::uint64_t>(std::llround(distance / period_ns_));
  }
  return std::nullopt;
}

void PeriodCount::count(const Sample& sample) {
  if (!knows_period()) {
    return;
  }
  if (sample.begins_stretch || stretches_ == 0) {
    ++stretches_;
    last_ = sample;
    passed_over_ = 0;
    return;
  }
  const std::int64_t distance_ns = sample.stamp_ns - last_.stamp_ns;
  const std::uint64_t numbered = sample.number - last_.number;
  const auto periods = periods_in(distance_ns, numbered);
  if (!periods) {
    if (++passed_over_ >= max_passed_over) {
      ++stretches_;
      last_ = sample;
      passed_over_ = 0;
    }
    return;
  }
  if (*periods > numbered) {
    gaps_.push_back({last_.stamp_ns, sample.stamp_ns, *periods - numbered});
    unnumbered_ += *periods - numbered;
  }
  span_ns_ += distance_ns;
  periods_ += *periods;
  last_ = sample;
  passed_over_ = 0;
}

std::vector<UnnumberedGap> PeriodCount::take_gaps() {
  return std::exchange(gaps_, {});
}

double PeriodCount::mean_ns() const {
  return static_cast<double>(static_cast<long double>(span_ns_) /
                             static_cast<long double>(periods_));
}

} // namespace dyncal::analysis
