// From what drivers deliver to the messages of the contract (idl/README.md explains every field).
// Plain functions, any thread.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/sample_block.hpp"
#include "idl/dyncal.h"
#include "services/stream/source_publisher.hpp"

namespace dyncal::inline stream {

[[nodiscard]] dyncal::wire::SourceDescription
to_message(const SourceOptions& source, std::uint64_t session, const std::string& software,
           const drivers::SourceDescription& description);

// Takes the block's arrays over; channel_count follows from them.
[[nodiscard]] dyncal::wire::SampleBlock to_message(const SourceOptions& source,
                                                   std::uint64_t session,
                                                   std::uint64_t block_number,
                                                   drivers::SampleBlock block);

// The record of a shot, or with no samples an empty one; channel_count follows from the values.
[[nodiscard]] dyncal::wire::TriggeredRecord to_message(const SourceOptions& source,
                                                       std::uint64_t session, const Shot& shot,
                                                       drivers::SampleBlock block);

// All fields but the counts of the publishing service itself (rate, buffer, readers, state).
[[nodiscard]] dyncal::wire::SourceStatus to_message(const SourceOptions& source,
                                                    const SourcePublisher::Snapshot& snapshot);

} // namespace dyncal::inline stream
