#include "services/evaluation/mean_points.hpp"

#include <algorithm>
#include <iterator>
#include <map>

#include "services/evaluation/closures/channel_run.hpp"
#include "services/evaluation/result/point_identity.hpp"

namespace dyncal::inline evaluation {

std::vector<FrequencyPoint> mean_points(const std::vector<const StepResult*>& results) {
  std::map<PointIdentity, std::vector<const StepResult*>> by_point;
  for (const StepResult* result : results) {
    by_point[mean_identity_of(*result)].push_back(result);
  }
  // All at once: how much runs scatter shows at all frequencies together.
  std::vector<analysis::RepeatedFrequency> repeated;
  for (const auto& [point, of_point] : by_point) {
    repeated.push_back({point.frequency_hz, {}});
    std::transform(of_point.begin(), of_point.end(),
                   std::back_inserter(repeated.back().repetitions),
                   [](const StepResult* result) { return repetition_of(*result); });
  }
  const auto means = analysis::means_of_repetitions(repeated);
  std::vector<FrequencyPoint> points;
  auto mean = means.begin();
  for (const auto& [point, of_point] : by_point) {
    if (*mean) {
      const StepResult& first = *of_point.front();
      points.push_back({first.frequency_text_hz, first.frequency_hz, first.level_m_s2, **mean,
                        (*mean)->phase_rad});
    }
    ++mean;
  }
  return points;
}

} // namespace dyncal::inline evaluation
