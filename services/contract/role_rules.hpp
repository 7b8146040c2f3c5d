// Which channels may have which role: the rules that the bench file and a recipe from the bus have
// in common.
//
// A rule that is broken names the role, spelled as in the bench file, and completes a sentence
// whose subject is that role: "must be of the same source as the reference: ...". Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/contract/channel_name.hpp"
#include "services/contract/evaluation_method.hpp"

namespace dyncal::inline contract {

struct RoleNames {
  EvaluationMethod method = EvaluationMethod::sample_timestamping;
  ChannelName reference;
  ChannelName sync_acs;         // empty where there is none
  ChannelName sync_sensor;      // sync_dau or sync_dso, by the method; empty where there is none
  std::vector<ChannelName> dut; // the channels under calibration
  std::optional<ChannelName> temperature{};
};

struct RoleProblem {
  std::string role;     // "dut"
  std::string sentence; // "names no channel under calibration: ..."
};

// The first rule that these roles break.
[[nodiscard]] std::optional<RoleProblem> find_role_problem(const RoleNames& roles);

// A channel that has two roles is measured against itself: its result is a number, and wrong. Only
// a bench file is held to this; the calibration of an ADC compares a channel with itself on
// purpose.
[[nodiscard]] std::optional<RoleProblem> find_repeated_channel(const RoleNames& roles);

// Every channel under calibration is of another source than sync_dau: the sensors have stamps of
// their own, and sync is recorded beside them.
[[nodiscard]] bool has_own_clocks(const std::vector<ChannelName>& dut, const ChannelName& sync_dau);

} // namespace dyncal::inline contract
