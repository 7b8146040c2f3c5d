#include "services/evaluation/closures/mountings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/base/statistics.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr std::size_t least_points = 3;
constexpr double u_of_median = 1.2533; // of that of a mean

using Results = std::vector<const StepResult*>;

double angular(const StepResult& result) {
  return 2.0 * std::numbers::pi * result.frequency_hz;
}

const StepResult* at_point_of(const StepResult& result, const Results& others) {
  const auto found = std::find_if(others.begin(), others.end(), [&](const StepResult* one) {
    return one->frequency_hz == result.frequency_hz && one->level_m_s2 == result.level_m_s2;
  });
  return found == others.end() ? nullptr : *found;
}

// Against another repetition; nothing where they have too few points in common.
std::optional<Mounting> against(const Results& results, const Results& others) {
  std::vector<double> magnitudes, delays_s;
  double variances = 0.0;
  for (const StepResult* result : results) {
    const StepResult* other = at_point_of(*result, others);
    if (other == nullptr || !(result->magnitude > 0.0 && other->magnitude > 0.0)) {
      continue;
    }
    const analysis::Repetition one = repetition_of(*result), two = repetition_of(*other);
    const std::complex<double> d = std::log(one.h / two.h);
    magnitudes.push_back(d.real());
    delays_s.push_back(d.imag() / angular(*result));
    variances += std::pow(one.u_random_magnitude_rel, 2) + std::pow(two.u_random_magnitude_rel, 2);
  }
  if (magnitudes.size() < least_points) {
    return std::nullopt;
  }
  const double n = static_cast<double>(magnitudes.size());
  return Mounting{analysis::median(magnitudes), analysis::median(delays_s),
                  u_of_median * std::sqrt(variances) / n};
}

} // namespace

Mountings::Mountings(const ChannelRun& run) {
  std::map<std::uint32_t, Results> repetitions;
  for (const StepResult* result : run.results) {
    repetitions[result->repetition].push_back(result);
  }
  const Results* before = nullptr;
  for (const auto& [repetition, results] : repetitions) {
    const bool is_last = repetition == repetitions.rbegin()->first;
    if (before == nullptr) {
      of_repetitions_[repetition] = {};
    } else if (is_last && results.size() == 1) { // the first step once more
      of_repetitions_[repetition] = std::prev(of_repetitions_.end())->second;
    } else {
      const auto mounting = against(results, *before);
      known_ = known_ && mounting.has_value();
      of_repetitions_[repetition] = mounting.value_or(Mounting{});
    }
    before = before == nullptr ? &results : before;
  }
  centre();
}

void Mountings::centre() {
  std::vector<double> magnitudes, delays_s;
  for (const auto& [repetition, one] : of_repetitions_) {
    magnitudes.push_back(one.magnitude_log);
    delays_s.push_back(one.delay_s);
  }
  if (magnitudes.empty()) {
    return;
  }
  const double magnitude = analysis::median(magnitudes), delay_s = analysis::median(delays_s);
  for (auto& [repetition, one] : of_repetitions_) {
    one.magnitude_log -= magnitude;
    one.delay_s -= delay_s;
  }
}

analysis::Repetition Mountings::value_of(const StepResult& result) const {
  const Mounting& mounting = of_repetitions_.at(result.repetition);
  analysis::Repetition value = repetition_of(result);
  value.h *= std::polar(std::exp(-mounting.magnitude_log), -mounting.delay_s * angular(result));
  return value;
}

std::vector<PointRepetitions> Mountings::points(const ChannelRun& run) const {
  std::vector<PointRepetitions> all = points_of(run);
  for (PointRepetitions& point : all) {
    for (std::size_t i = 0; i < point.values.size(); ++i) {
      point.values[i] = value_of(*point.results[i]);
    }
  }
  return all;
}

std::pair<std::uint32_t, Mounting> Mountings::farthest() const {
  return *std::max_element(
      of_repetitions_.begin(), of_repetitions_.end(), [](const auto& one, const auto& other) {
        return std::abs(one.second.magnitude_log) < std::abs(other.second.magnitude_log);
      });
}

} // namespace dyncal::inline evaluation
