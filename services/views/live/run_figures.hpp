// The figures of a run as far as the bus has brought its results: those of its files
// (services/views/report/run_figures.hpp) once it is over, and while it lasts the same pictures of
// what there is, with plain means. The thread of the laboratory.
#pragma once

#include <string>
#include <vector>

#include "services/network/run.hpp"
#include "services/views/figures/transfer_function.hpp"

namespace dyncal::inline views::live {

// Transfer function and deviations of the channel, then the sample clock of its source as far as it
// was reported. Empty: the run has no result of this channel.
[[nodiscard]] std::vector<figures::Figure> run_figures(const std::string& bench,
                                                       const network::Run& run,
                                                       const std::string& channel,
                                                       figures::ErrorBars error_bars);

} // namespace dyncal::inline views::live
