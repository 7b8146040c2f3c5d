#include "analysis/clock/temperature_relation.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {

void TemperatureRelation::Moments::add(double value) {
  ++count;
  const double before = value - mean;
  mean += before / static_cast<double>(count);
  squares += before * (value - mean);
}

void TemperatureRelation::Moments::merge(const Moments& other) {
  const double a = static_cast<double>(count), b = static_cast<double>(other.count);
  const double difference = other.mean - mean;
  count += other.count;
  mean += difference * b / (a + b);
  squares += other.squares + difference * difference * a * b / (a + b);
}

TemperatureRelation::TemperatureRelation(std::size_t max_bins, std::size_t max_pairs)
    : max_bins_(std::max<std::size_t>(max_bins, 2)),
      max_pairs_(std::max<std::size_t>(max_pairs, 2)) {}

void TemperatureRelation::add(double temperature_degc, std::int64_t interval_ns) {
  if (!std::isfinite(temperature_degc) || std::abs(temperature_degc) > 1e6) {
    return;
  }
  const auto interval = static_cast<double>(interval_ns);
  const double from_mean = temperature_degc - temperature_.mean; // of the temperatures before
  temperature_.add(temperature_degc);
  interval_.add(interval);
  products_ += from_mean * (interval - interval_.mean);
  bins_[static_cast<std::int64_t>(std::floor(temperature_degc / bin_degc_))].add(interval);
  while (bins_.size() > max_bins_) {
    widen_bins();
  }
  if ((interval_.count - 1) % every_ == 0) {
    keep_pair(temperature_degc, interval);
  }
}

void TemperatureRelation::widen_bins() {
  std::map<std::int64_t, Moments> wider;
  for (const auto& [index, moments] : bins_) {
    wider[index >= 0 ? index / 2 : (index - 1) / 2].merge(moments);
  }
  bins_ = std::move(wider);
  bin_degc_ *= 2.0;
}

void TemperatureRelation::keep_pair(double temperature_degc, double interval_ns) {
  if (pair_intervals_ns_.size() == max_pairs_) {
    for (std::size_t i = 0; 2 * i < max_pairs_; ++i) {
      pair_temperatures_degc_[i] = pair_temperatures_degc_[2 * i];
      pair_intervals_ns_[i] = pair_intervals_ns_[2 * i];
    }
    pair_temperatures_degc_.resize((max_pairs_ + 1) / 2);
    pair_intervals_ns_.resize((max_pairs_ + 1) / 2);
    every_ *= 2;
    if ((interval_.count - 1) % every_ != 0) {
      return;
    }
  }
  pair_temperatures_degc_.push_back(temperature_degc);
  pair_intervals_ns_.push_back(interval_ns);
}

double TemperatureRelation::correlation() const {
  const double product = temperature_.squares * interval_.squares;
  return product > 0.0 ? products_ / std::sqrt(product) : 0.0;
}

double TemperatureRelation::slope_ns_per_degc() const {
  return temperature_.squares > 0.0 ? products_ / temperature_.squares : 0.0;
}

std::vector<TemperatureBin> TemperatureRelation::bins() const {
  std::vector<TemperatureBin> result;
  for (const auto& [index, moments] : bins_) {
    const double sd = moments.count > 1
                          ? std::sqrt(moments.squares / static_cast<double>(moments.count - 1))
                          : 0.0;
    result.push_back(
        {(static_cast<double>(index) + 0.5) * bin_degc_, moments.mean, sd, moments.count});
  }
  return result;
}

} // namespace dyncal::analysis
