// How far the repetitions of a run are from their mean, as a picture: magnitude in per cent above,
// phase in degrees below it, with bars of u and the uncertainty of the mean as a band; and lowest,
// where it is known, what the fitted sine leaves of the channel, in per cent of its amplitude.
//
//   deviation = |H| / |mean H| - 1,   phase - phase of the mean (lead, the turn next to it)
//
// A repetition whose frequency and level have no mean is left out. Means that are plain have no
// band; the bars are then those of the data. Without error bars there is neither bar nor band.
#pragma once

#include <string>

#include "services/views/figures/transfer_function.hpp"

namespace dyncal::inline views::figures {

[[nodiscard]] Figure deviation_figure(const TransferFunctionData& data, const std::string& name);

} // namespace dyncal::inline views::figures
