#include "services/evaluation/method/disturbance_cut.hpp"

#include <fmt/core.h>

namespace dyncal::inline evaluation {
namespace {

bool cut(const analysis::KnockedChannel& found, std::initializer_list<SelectedChannels*> parts,
         std::vector<Flag>& flags) {
  for (SelectedChannels* part : parts) {
    if (part->has(found.channel)) {
      part->leave_out({found.knock.first_ns, found.knock.last_ns + 1});
      const double length_ms =
          static_cast<double>(found.knock.last_ns - found.knock.first_ns) * 1e-6;
      flags.push_back(flag_of_channel(ResultFlag::disturbance_cut_out, found.channel,
                                      fmt::format("{:.2g} ms", length_ms)));
      return true;
    }
  }
  return false;
}

} // namespace

analysis::Expected<EvaluatedStep>
evaluate_without_knocks(StepTask& task, std::initializer_list<SelectedChannels*> parts,
                        const std::function<analysis::Expected<EvaluatedStep>()>& evaluate) {
  if (task.given_up.stop_requested()) {
    return fail(analysis::ErrorCode::not_converged, "the run was given up");
  }
  auto step = evaluate();
  if (!step) {
    return step;
  }
  bool any = false;
  for (const analysis::KnockedChannel& found : step->findings.knocks) {
    any |= cut(found, parts, task.flags);
  }
  return any && !task.given_up.stop_requested() ? evaluate() : step;
}

} // namespace dyncal::inline evaluation
