// From the settings of a bench file to those of the driver for CAN. Any thread.
#pragma once

#include "drivers/can/stream_settings.hpp"
#include "services/bench/file/source_settings.hpp"

namespace dyncal::inline instruments {

// REQUIRES: the driver of the source is "can".
[[nodiscard]] drivers::can::StreamSettings stream_settings(const SourceSettings& source);

} // namespace dyncal::inline instruments
