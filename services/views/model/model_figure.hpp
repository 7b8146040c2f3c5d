// The residuals of a model as a figure (report/figures/model_residuals.hpp). Any thread.
#pragma once

#include "services/views/figures/figure.hpp"
#include "services/views/model/channel_model.hpp"

namespace dyncal::inline views {

// Named "model-residuals-SOURCE-CHANNEL".
[[nodiscard]] figures::Figure model_figure(const ChannelModel& model);

} // namespace dyncal::inline views
