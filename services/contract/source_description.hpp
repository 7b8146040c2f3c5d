// The description of a source as drivers give it, read from the contract's message.
//
// The other way is services/source/messages.hpp, where a source is published. Any thread.
#pragma once

#include "drivers/sample_block.hpp"

namespace dyncal::wire {
class SourceDescription;
}

namespace dyncal::services {

[[nodiscard]] drivers::SourceDescription from_message(const wire::SourceDescription& message);

} // namespace dyncal::services
