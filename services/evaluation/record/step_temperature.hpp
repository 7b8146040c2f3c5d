// The temperature of the sensor during a step, from the recipe's temperature channel. Plain
// function; any thread.
#pragma once

#include <optional>

#include "services/contract/channel_name.hpp"
#include "services/evaluation/record/run_records.hpp"

namespace dyncal::inline evaluation {

// Mean in degrees Celsius over the whole interval of the step, settling included; samples that are
// not trusted or not measured are left out. Nothing without such samples, and where the channel's
// unit is no temperature. REQUIRES: the step was searched.
[[nodiscard]] std::optional<double>
step_temperature_degc(const RunRecords& records, const ChannelName& channel, std::size_t step);

} // namespace dyncal::inline evaluation
