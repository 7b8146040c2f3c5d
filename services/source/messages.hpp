// From what drivers say to the messages of the contract (idl/README.md explains every field).
// Plain functions, any thread.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/sample_block.hpp"
#include "idl/dyncal.h"
#include "services/source/source_publisher.hpp"

namespace dyncal::services {

// The topic on which a source of this kind publishes its samples.
[[nodiscard]] const char* sample_topic(SourceKind kind);

[[nodiscard]] dyncal::wire::SourceDescription
to_message(const SourceOptions& source, std::uint64_t session, const std::string& software,
           const drivers::SourceDescription& description);

// Takes the block's arrays over; channel_count follows from them.
[[nodiscard]] dyncal::wire::SampleBlock to_message(const SourceOptions& source,
                                                   std::uint64_t session,
                                                   std::uint64_t block_number,
                                                   drivers::SampleBlock block);

// All fields but the counts of the publishing service itself (rate, buffer, readers, state).
[[nodiscard]] dyncal::wire::SourceStatus to_message(const SourceOptions& source,
                                                    const SourcePublisher::Snapshot& snapshot);

} // namespace dyncal::services
