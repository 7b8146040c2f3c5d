#include "services/evaluation/closures/channel_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/core.h>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/uncertainty/coverage.hpp"
#include "services/evaluation/result/point_identity.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double follows = 10.0; // standard uncertainties

} // namespace

double limit_by_chance(std::size_t comparisons, double degrees_of_freedom) {
  const double chance =
      chance_of_closure / static_cast<double>(std::max<std::size_t>(1, comparisons));
  return analysis::coverage_factor(degrees_of_freedom, 1.0 - chance);
}

double chi_squared_by_chance(std::size_t comparisons, double degrees_of_freedom) {
  // One side of a normal deviate that has this chance.
  const double chance =
      chance_of_closure / static_cast<double>(std::max<std::size_t>(1, comparisons));
  const double quantile =
      analysis::coverage_factor(analysis::infinite_degrees_of_freedom, 1.0 - 2.0 * chance);
  return analysis::chi_squared_limit(degrees_of_freedom, quantile);
}

bool ChannelRun::moves() const {
  const auto moving = std::count_if(results.begin(), results.end(), [](const StepResult* one) {
    return one->magnitude > follows * one->u_magnitude;
  });
  return 2 * static_cast<std::size_t>(moving) > results.size();
}

std::string ChannelRun::place_of(const StepResult& result) const {
  return have_several_levels(recipe.steps)
             ? fmt::format("{} Hz, {} m/s^2", result.frequency_text_hz, result.level_m_s2)
             : result.frequency_text_hz + " Hz";
}

std::string source_of(const std::string& channel) {
  return parse_channel_name(channel).value_or(ChannelName{}).source;
}

const StepResult* in_same_step(const StepResult& result, const ChannelRun& other) {
  const auto found = std::find_if(other.results.begin(), other.results.end(), [&](const auto* one) {
    return one->step == result.step && one->repetition == result.repetition;
  });
  return found == other.results.end() ? nullptr : *found;
}

analysis::Repetition repetition_of(const StepResult& result) {
  analysis::Repetition value =
      analysis::make_repetition(std::polar(result.magnitude, result.phase_rad), result.budget);
  value.sweep = result.repetition;
  return value;
}

std::vector<PointRepetitions> points_of(const ChannelRun& run) {
  std::map<PointIdentity, PointRepetitions> points;
  for (const StepResult* result : run.results) {
    PointRepetitions& point = points[mean_identity_of(*result)];
    point.results.push_back(result);
    point.values.push_back(repetition_of(*result));
  }
  std::vector<PointRepetitions> all;
  all.reserve(points.size());
  for (auto& [key, point] : points) {
    all.push_back(std::move(point));
  }
  return all;
}

Closure not_possible(ClosureKind kind, std::string subject, std::string why) {
  return {.kind = kind, .subject = std::move(subject), .sentence = std::move(why)};
}

Closure judged(ClosureKind kind, std::string subject, const Comparison& comparison,
               std::string sentence) {
  const auto& [value, u, limit, unit] = comparison;
  return {.kind = kind,
          .subject = std::move(subject),
          .verdict = std::abs(value) <= limit ? Verdict::closes : Verdict::open,
          .value = value,
          .u = u,
          .limit = limit,
          .unit = unit,
          .sentence = std::move(sentence)};
}

} // namespace dyncal::inline evaluation
