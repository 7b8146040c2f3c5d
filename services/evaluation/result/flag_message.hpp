// Flags as the contract's messages carry them, as sentences and names, both ways
// (services/contract/message_members.hpp). Any thread.
#pragma once

#include <vector>

#include "services/contract/message_members.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

void message_flags(MessageWriter& /*visit*/, const std::vector<Flag>& flags, auto& message) {
  message.flags() = sentences_of(flags);
  message.flag_names() = names_of(flags);
}

void message_flags(MessageReader& /*visit*/, std::vector<Flag>& flags, const auto& message) {
  flags = flags_from_message(message.flags(), message.flag_names());
}

} // namespace dyncal::inline evaluation
