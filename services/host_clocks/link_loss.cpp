#include "services/host_clocks/link_loss.hpp"

#include <algorithm>

namespace dyncal::services {
namespace {

bool has_come(const ProbesSent& sent, const ProbeCounts& told) {
  return told.series == sent.series && told.first > 0;
}

bool is_possible(const ProbesSent& sent, const ProbeCounts& told) {
  return told.newest <= sent.all && told.first <= told.newest && told.received > 0 &&
         told.received <= told.newest - told.first + 1 && told.echoed <= told.received;
}

} // namespace

Way way_there(const ProbesSent& sent, const ProbeCounts& told) {
  if (!has_come(sent, told)) {
    return {.sent = sent.due - std::min(sent.early, sent.due), .arrived = 0};
  }
  if (!is_possible(sent, told)) {
    return {};
  }
  return {.sent = std::max(told.newest, sent.due) - told.first + 1, .arrived = told.received};
}

Way way_back(const ProbesSent& sent, const ProbeCounts& told, const EchoCounts& echoes) {
  const bool known = has_come(sent, told) && is_possible(sent, told);
  const std::uint64_t echoed = std::max(echoes.newest, known ? told.echoed : 0);
  if (echoes.first == 0) {
    return {.sent = echoed, .arrived = 0};
  }
  return {.sent = echoed - echoes.first + 1, .arrived = echoes.received};
}

std::optional<double> lost_part(const Way& way) {
  if (way.sent < fewest_probes) {
    return std::nullopt;
  }
  return static_cast<double>(way.sent - way.arrived) / static_cast<double>(way.sent);
}

std::optional<ProbeCounts> probe_counts_of(const wire::ClockAnswer& answer) {
  if (!answer.answers_probes()) {
    return std::nullopt;
  }
  return ProbeCounts{.series = answer.probe_series(),
                     .first = answer.first_probe(),
                     .newest = answer.newest_probe(),
                     .received = answer.probes_received(),
                     .echoed = answer.probes_echoed()};
}

} // namespace dyncal::services
