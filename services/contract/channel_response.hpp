// What a channel reads over what is, over frequency, as a file of its calibration states it. Plain
// data, any thread.
#pragma once

#include <vector>

#include "analysis/instrument/reference_calibration.hpp"
#include "services/contract/channel_name.hpp"

namespace dyncal::inline contract {

struct ChannelResponse {
  ChannelName channel;
  std::vector<analysis::ReferenceCalibrationPoint> points;
};

} // namespace dyncal::inline contract
