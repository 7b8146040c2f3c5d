// The channel of the reference as a step's evaluation takes it, and the quantity that responses are
// per.
//
// A displacement that its source makes of the quadrature signals of a laser interferometer is taken
// without the slow motion of the table (analysis/method/motion_channel.hpp), responses are per
// acceleration, and the interferometer's uncertainty is in the budget
// (analysis/interferometer/interferometer_budget.hpp), as the source described it when the step was
// complete. Any other reference is taken as it is, and responses are per what it measures.
//
// Fails (ill_conditioned) where the source knows no ellipse, or not what the ellipse leaves of the
// periodic error. REQUIRES: the first of the selected channels is the reference. Plain functions,
// any thread.
#pragma once

#include <string>

#include "analysis/base/error.hpp"
#include "analysis/method/transfer_point.hpp"
#include "services/evaluation/method/selected_channels.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] analysis::Expected<analysis::ChannelSamples>
reference_channel(const SelectedChannels& selected);

// Whether responses are per another quantity than the reference's, and the unit that they are per.
[[nodiscard]] bool is_differentiated(const SelectedChannels& selected);
[[nodiscard]] std::string excitation_unit(const SelectedChannels& selected);

// What settling is looked for in: a displacement without the slow motion of the table. REQUIRES:
// the selected channels live as long as it does.
[[nodiscard]] StepSamples settling_samples(const SelectedChannels& selected, double frequency_hz);

// The sine of the reference in that unit, for whoever looks at results.
[[nodiscard]] analysis::ChannelFit excitation_fit(const SelectedChannels& selected,
                                                  analysis::ChannelFit fit);

} // namespace dyncal::inline evaluation
