#include "services/evaluation/method/channel_responses.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/phasor.hpp"
#include "services/evaluation/method/step_results.hpp"

namespace dyncal::inline evaluation {
namespace {

analysis::Contribution row_of(const analysis::ReferenceContribution& one) {
  return {.kind = analysis::ContributionKind::other,
          .subject = "response of the channel" + (one.name.empty() ? "" : ", " + one.name),
          .distribution = one.distribution,
          .degrees_of_freedom = one.degrees_of_freedom,
          .u_magnitude_rel = one.u_magnitude_rel,
          .u_phase_rad = one.u_phase_rad};
}

void take(const analysis::ReferenceResponse& response, StepResult& result) {
  result.magnitude /= response.magnitude;
  result.u_magnitude /= response.magnitude;
  result.phase_rad = analysis::wrap_phase(result.phase_rad - response.phase_rad);
  for (const analysis::ReferenceContribution& one : response.contributions) {
    result.u_magnitude = std::hypot(result.u_magnitude, one.u_magnitude_rel * result.magnitude);
    result.u_phase_rad = std::hypot(result.u_phase_rad, one.u_phase_rad);
    result.budget.push_back(row_of(one));
  }
}

} // namespace

std::vector<bool> take_channel_responses(const Recipe& recipe, std::vector<StepResult>& results) {
  std::vector<bool> has_changed(results.size(), false);
  for (std::size_t i = 0; i < results.size(); ++i) {
    StepResult& result = results[i];
    const auto found =
        std::ranges::find_if(recipe.channel_responses, [&](const ChannelResponse& one) {
          return one.channel.text() == result.channel;
        });
    if (!result.valid || found == recipe.channel_responses.end()) {
      continue;
    }
    const auto response =
        analysis::reference_response_at(found->points, result.frequency_hz, result.level_m_s2);
    if (!response) {
      add_refusal(response.error().message, result);
      continue;
    }
    take(*response, result);
    has_changed[i] = true;
  }
  return has_changed;
}

} // namespace dyncal::inline evaluation
