// Out of a series as the sensor sends it, the channels that the bench calibrates: by our names (the
// source's `channels` renames), in the order of the role `dut`. So a source describes the same
// channels before its first series as after it. Fails (device) when the sensor does not have one of
// them; the message lists those it has. Any thread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drivers/tss/series.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline instruments {

[[nodiscard]] Expected<drivers::tss::Series>
select_channels(drivers::tss::Series series, const std::map<std::string, std::string>& our_names,
                const std::vector<std::string>& wanted);

} // namespace dyncal::inline instruments
