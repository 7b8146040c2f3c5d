#include "analysis/clock/slip_spacing.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr std::size_t slips_that_tell = 4;
constexpr std::size_t max_slips = 64;
constexpr double most_off_line = 0.35; // of the distance; losses at random are beyond that at once

} // namespace

void SlipSpacing::add(std::uint64_t sample, std::uint64_t missing) {
  missing_ += missing;
  if (samples_.size() < max_slips) {
    samples_.push_back(static_cast<double>(sample));
  }
}

void SlipSpacing::take_back() {
  if (!samples_.empty() && samples_.size() < max_slips) {
    samples_.pop_back();
  }
}

bool SlipSpacing::are_regular() const {
  const auto n = static_cast<double>(samples_.size());
  double mean = 0.0, products = 0.0;
  for (const double sample : samples_) {
    mean += sample / n;
  }
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    products += (static_cast<double>(i) - 0.5 * (n - 1.0)) * (samples_[i] - mean);
  }
  const double distance = products / (n * (n * n - 1.0) / 12.0);
  double most_off = 0.0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const double on_line = mean + distance * (static_cast<double>(i) - 0.5 * (n - 1.0));
    most_off = std::max(most_off, std::abs(samples_[i] - on_line));
  }
  return most_off <= most_off_line * distance;
}

std::uint64_t SlipSpacing::unsure_losses() const {
  return samples_.size() < slips_that_tell || are_regular() ? missing_ : 0;
}

} // namespace dyncal::analysis
