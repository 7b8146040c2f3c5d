#include "services/contract/role_rules.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::inline contract {
namespace {

std::optional<RoleProblem> find_missing_sensor(const RoleNames& roles) {
  if (!roles.dut.empty() || roles.method == EvaluationMethod::sample_timestamping) {
    return std::nullopt;
  }
  const bool by_series = roles.method == EvaluationMethod::series_timestamping;
  return RoleProblem{"dut", fmt::format("names no channel under calibration, which this method "
                                        "needs: give them, for example [\"{}/acceleration_z\"]",
                                        by_series ? "tss" : "can")};
}

std::optional<RoleProblem> find_sync_problem(const RoleNames& roles) {
  if (!roles.sync_acs.source.empty() && roles.sync_acs.source != roles.reference.source) {
    return RoleProblem{"sync_acs",
                       "must be of the same source as the reference: the two must share a clock"};
  }
  if (is_without_sync(roles.method) || roles.sync_sensor.source != roles.reference.source) {
    return std::nullopt;
  }
  const bool by_series = roles.method == EvaluationMethod::series_timestamping;
  return RoleProblem{by_series ? "sync_dso" : "sync_dau",
                     "must not be of the source of sync_acs: the method links two clocks"};
}

std::optional<RoleProblem> find_sensor_problem(const RoleNames& roles) {
  for (const ChannelName& name : roles.dut) {
    if (roles.method == EvaluationMethod::analogue && name.source != roles.reference.source) {
      return RoleProblem{"dut", fmt::format("names \"{}\", but the analogue method compares "
                                            "channels of one system: those of source '{}'",
                                            name.text(), roles.reference.source)};
    }
    const auto own_clock = [&](const ChannelName& one) {
      return one.source != roles.sync_sensor.source;
    };
    if (roles.method == EvaluationMethod::sample_timestamping &&
        own_clock(name) != own_clock(roles.dut.front())) {
      return RoleProblem{"dut", fmt::format("names \"{}\" and \"{}\", but the channels must be "
                                            "either all of the source of sync_dau, whose stamps "
                                            "they share, or none of them",
                                            roles.dut.front().text(), name.text())};
    }
    if (roles.method == EvaluationMethod::series_timestamping &&
        name.source != roles.dut.front().source) {
      return RoleProblem{"dut", "names channels of two sources: series time stamping calibrates "
                                "one sensor at a time"};
    }
  }
  return std::nullopt;
}

} // namespace

std::optional<RoleProblem> find_role_problem(const RoleNames& roles) {
  if (auto problem = find_missing_sensor(roles)) {
    return problem;
  }
  if (auto problem = find_sync_problem(roles)) {
    return problem;
  }
  return find_sensor_problem(roles);
}

std::optional<RoleProblem> find_repeated_channel(const RoleNames& roles) {
  const bool by_series = roles.method == EvaluationMethod::series_timestamping;
  std::vector<std::pair<const char*, const ChannelName*>> used{{"reference", &roles.reference}};
  // Without sync, the channel that the steps are found in may be the reference.
  if (!is_without_sync(roles.method) || roles.sync_acs != roles.reference) {
    used.emplace_back("sync_acs", &roles.sync_acs);
  }
  used.emplace_back(by_series ? "sync_dso" : "sync_dau", &roles.sync_sensor);
  for (const ChannelName& name : roles.dut) {
    used.emplace_back("dut", &name);
  }
  if (roles.temperature) {
    used.emplace_back("temperature", &*roles.temperature);
  }
  for (auto later = used.begin(); later != used.end(); ++later) {
    const auto earlier = std::find_if(
        used.begin(), later, [&](const auto& one) { return *one.second == *later->second; });
    if (earlier != later && !later->second->source.empty()) {
      return RoleProblem{
          later->first, fmt::format("names \"{}\", which is {} already: every role needs a channel "
                                    "of its own",
                                    later->second->text(), earlier->first)};
    }
  }
  return std::nullopt;
}

bool has_own_clocks(const std::vector<ChannelName>& dut, const ChannelName& sync_dau) {
  return !dut.empty() && dut.front().source != sync_dau.source;
}

} // namespace dyncal::inline contract
