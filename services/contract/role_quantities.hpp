// Which quantities a role may have, held against what is known of its channel.
//
//   reference        the quantity of the level, or another of motion or load (a velocity, an
//                    angular velocity, a force): not electrical, no temperature, no time
//   sync_acs,        a voltage, or the current of the exciter; without sync (analogue,
//   sync_dau/_dso    absolute-time) sync_acs only finds the steps, in whatever is excited
//   temperature      a temperature
//   dut              anything but a temperature and a time; a voltage is a sensor behind an ADC
//
// The unit of a channel counts, and the word or unit that its source has for it where that says
// another quantity than the unit of the bench file. What is not known is no contradiction. A
// channel that is compared with itself (the calibration of an ADC) has no quantity to hold against.
//
// Each sentence completes one whose subject is the role, as role_rules.hpp, and says which two
// roles have to be exchanged where that makes both right. Any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/contract/role_rules.hpp"

namespace dyncal::inline contract {

struct RoleQuantityProblem {
  std::string role;      // "sync_acs"
  std::size_t entry = 0; // of dut
  std::string sentence;  // "names "acs/reference", in m/s^2: an acceleration, ..."
};

// What is known of a channel; nothing: not described yet, or there is none of that name.
using DescribedChannel =
    std::function<std::optional<drivers::ChannelDescription>(const ChannelName&)>;

// In the order reference, sync_acs, sync of the sensor, temperature, dut.
[[nodiscard]] std::vector<RoleQuantityProblem>
find_quantity_problems(const RoleNames& roles, const DescribedChannel& described);

} // namespace dyncal::inline contract
