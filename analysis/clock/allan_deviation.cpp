#include "analysis/clock/allan_deviation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dyncal::analysis {

double overlapping_allan_deviation(std::span<const double> phases_s, double tau0_s, std::size_t m) {
  if (m == 0 || phases_s.size() <= 2 * m) {
    return 0.0;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i + 2 * m < phases_s.size(); ++i) {
    const double second = phases_s[i + 2 * m] - 2.0 * phases_s[i + m] + phases_s[i];
    sum += second * second;
  }
  const double tau = static_cast<double>(m) * tau0_s;
  return std::sqrt(sum / (2.0 * tau * tau * static_cast<double>(phases_s.size() - 2 * m)));
}

StreamingAllan::StreamingAllan(std::size_t max_samples)
    : ring_(8), longest_(std::bit_floor(std::max<std::size_t>(max_samples, 8))) {}

void StreamingAllan::add(std::int64_t stamp_ns) {
  // The ring must hold 2 m + 1 stamps for every m in use; it doubles while it may and the stretch
  // needs it.
  if (in_stretch_ == ring_.size() && ring_.size() < longest_) {
    std::vector<std::int64_t> larger(2 * ring_.size());
    for (std::uint64_t k = total_ - in_stretch_; k < total_; ++k) {
      larger[k & (larger.size() - 1)] = ring_[k & (ring_.size() - 1)];
    }
    ring_ = std::move(larger);
  }
  const std::size_t mask = ring_.size() - 1;
  ring_[total_ & mask] = stamp_ns;
  ++in_stretch_;
  std::size_t octave = 0;
  for (std::uint64_t m = 1; 2 * m < std::min<std::uint64_t>(in_stretch_, ring_.size());
       m *= 2, ++octave) {
    const std::int64_t middle = ring_[(total_ - m) & mask];
    const std::int64_t first = ring_[(total_ - 2 * m) & mask];
    const auto second = static_cast<double>((stamp_ns - middle) - (middle - first));
    if (octave == octaves_.size()) {
      octaves_.emplace_back();
    }
    octaves_[octave].squares_ns2 += second * second;
    ++octaves_[octave].terms;
  }
  ++total_;
}

std::vector<AllanPoint> StreamingAllan::points(double tau0_s) const {
  std::vector<AllanPoint> result;
  double m = 1.0;
  for (const Octave& octave : octaves_) {
    const double tau = m * tau0_s;
    if (static_cast<double>(octave.terms) > m) {
      result.push_back({tau, std::sqrt(octave.squares_ns2 * 1e-18 /
                                       (2.0 * tau * tau * static_cast<double>(octave.terms)))});
    }
    m *= 2.0;
  }
  return result;
}

} // namespace dyncal::analysis
