// Names of channels in files of the public SmartUp receiver, as drivers/smartup gives them to the
// same sensor: the group of the hierarchy in lower case, with x, y, z behind it when it has three
// members ("Acceleration" -> acceleration_x; voltages keep their numbers), the group alone when it
// has one, else the group with its number. And what the receiver's figures mean. Plain functions,
// any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::files {

// REQUIRES: index < members
[[nodiscard]] std::string receiver_channel(const std::string& group, std::size_t index,
                                           std::size_t members);

// The unit sends four standard uncertainties; 0 means that it does not trust its clock.
[[nodiscard]] std::uint32_t receiver_uncertainty_ns(std::uint32_t sent);

// Flags of the stamps that say so themselves (uncertainty 0, time 0), before StampOrder.
void flag_receiver_stamps(SampleBlock& block);

} // namespace dyncal::drivers::files
