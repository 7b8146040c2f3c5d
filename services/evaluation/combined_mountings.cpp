#include "services/evaluation/combined_mountings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "services/evaluation/mean_points.hpp"
#include "services/evaluation/result/point_identity.hpp"
#include "services/evaluation/transfer_summary.hpp"

namespace dyncal::inline evaluation {
namespace {

using analysis::Contribution;
using analysis::Repeats;
using OfPoint = std::map<PointIdentity, std::vector<const StepResult*>>;

OfPoint by_point(const std::vector<StepResult>& results) {
  OfPoint points;
  for (const StepResult& result : results) {
    if (result.valid) {
      points[mean_identity_of(result)].push_back(&result);
    }
  }
  return points;
}

// Of a mean over repetitions, whose first is `first`.
std::vector<Contribution> budget_of(const StepResult& first, const analysis::RepetitionMean& mean) {
  std::vector<Contribution> budget;
  for (Contribution row : first.budget) {
    const bool is_anew = row.repeats == Repeats::anew;
    if (is_anew) { // but for the part that lasts
      row.repeats = Repeats::common;
      row.u_magnitude_rel = row.u_lasting_magnitude_rel;
      row.u_phase_rad = row.u_lasting_magnitude_rel = 0.0;
    }
    if (!is_anew || row.u_magnitude_rel > 0.0) {
      budget.push_back(row);
    }
  }
  Contribution anew{.kind = analysis::ContributionKind::other,
                    .subject = "repetitions of one mounting",
                    .repeats = Repeats::anew};
  anew.u_magnitude_rel = mean.independent_magnitude_rel.u;
  anew.u_phase_rad = mean.independent_phase.u;
  anew.degrees_of_freedom = std::min(mean.independent_magnitude_rel.degrees_of_freedom,
                                     mean.independent_phase.degrees_of_freedom);
  budget.push_back(anew);
  return budget;
}

void add_uncertainty(StepResult& result) {
  double magnitude2 = 0.0, phase2 = 0.0;
  for (const Contribution& row : result.budget) {
    magnitude2 += row.u_magnitude_rel * row.u_magnitude_rel;
    phase2 += row.u_phase_rad * row.u_phase_rad;
  }
  result.u_magnitude = std::sqrt(magnitude2) * result.magnitude;
  result.u_phase_rad = std::sqrt(phase2);
}

StepResult mounting_result(const std::vector<const StepResult*>& repetitions,
                           const analysis::RepetitionMean& mean, std::uint32_t mounting) {
  const StepResult& first = *repetitions.front();
  StepResult result;
  result.channel = first.channel;
  result.repetition = mounting;
  result.frequency_text_hz = first.frequency_text_hz;
  result.frequency_hz = first.frequency_hz;
  result.level_m_s2 = first.level_m_s2;
  result.excited_axis = first.excited_axis;
  result.valid = true;
  result.magnitude = mean.magnitude;
  result.phase_rad = mean.phase_rad;
  result.unit = first.unit;
  result.budget = budget_of(first, mean);
  add_uncertainty(result);
  for (const StepResult* repetition : repetitions) {
    result.lost += repetition->lost;
  }
  return result;
}

// Of one channel's points those that all mountings have.
std::set<PointIdentity> whole_points(const OfPoint& points, std::uint32_t mountings) {
  std::set<PointIdentity> whole;
  for (const auto& [point, results] : points) {
    std::set<std::uint32_t> of;
    for (const StepResult* result : results) {
      of.insert(result->repetition);
    }
    if (of.size() == mountings) {
      whole.insert(point);
    }
  }
  return whole;
}

} // namespace

std::vector<StepResult> mounting_results(const std::vector<StepResult>& results,
                                         std::uint32_t mounting) {
  std::map<std::string, std::vector<const StepResult*>> channels;
  for (const StepResult& result : results) {
    if (result.valid) {
      channels[result.channel].push_back(&result);
    }
  }
  const OfPoint points = by_point(results);
  std::vector<StepResult> means;
  for (const auto& [channel, of_channel] : channels) {
    for (const FrequencyPoint& point : mean_points(of_channel)) {
      PointIdentity identity = mean_identity_of(*of_channel.front());
      identity.frequency_hz = point.frequency_hz;
      identity.level_m_s2 = point.level_m_s2;
      means.push_back(mounting_result(points.at(identity), point.mean, mounting));
      means.back().step = static_cast<std::uint32_t>(means.size());
    }
  }
  return means;
}

std::vector<TransferFunction> combined_functions(const std::vector<StepResult>& results,
                                                 std::uint32_t mountings) {
  const std::set<PointIdentity> whole = whole_points(by_point(results), mountings);
  const Recipe recipe; // what it does not state is in the results already
  TransferSummary summary(recipe);
  for (const StepResult& result : results) {
    if (whole.contains(mean_identity_of(result))) {
      summary.add(result);
    }
  }
  std::vector<TransferFunction> functions = summary.transfer_functions();
  for (TransferFunction& function : functions) {
    function.flags.clear();
  }
  return functions;
}

} // namespace dyncal::inline evaluation
