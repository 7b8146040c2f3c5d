// The driver's account of one sensor in the form of the contract: totals, and causes by name.
#pragma once

#include "drivers/smartup/sample_sink.hpp"
#include "services/source/source_publisher.hpp"

namespace dyncal::services::dau {

// Causes that concern the whole address (datagrams, not samples) stand among those of every sensor
// received there.
[[nodiscard]] SourceCounts source_counts(const drivers::smartup::SensorCounts& sensor,
                                         const drivers::smartup::ReceptionCounts& reception);

} // namespace dyncal::services::dau
