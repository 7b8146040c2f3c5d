// The description of a source as drivers give it, in the contract's message and back, and whether
// another instrument has taken its place.
//
// What else the message has, whoever publishes the source adds (services/stream/messages.hpp). Any
// thread.
#pragma once

#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::wire {
class SourceDescription;
}

namespace dyncal::inline contract {

[[nodiscard]] wire::SourceDescription to_message(const drivers::SourceDescription& description);
[[nodiscard]] drivers::SourceDescription from_message(const wire::SourceDescription& message);

// One sentence that names both where device or serial number differ, as far as both are known;
// empty: nothing tells them apart. `first`: what the run began with.
[[nodiscard]] std::string device_difference(const std::string& source,
                                            const drivers::SourceDescription& first,
                                            const drivers::SourceDescription& now);

} // namespace dyncal::inline contract
