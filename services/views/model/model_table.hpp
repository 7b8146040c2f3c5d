// Models as people read them on the terminal: which kinds were tried, the chosen one with its
// parameters, the filter, and warnings last. Digits follow U (rounding.hpp). Any thread.
#pragma once

#include <string>

#include "services/views/model/channel_model.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string model_text(const ChannelModel& model);

} // namespace dyncal::inline views
