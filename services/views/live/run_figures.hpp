// The figures of a run as far as the bus has brought its results: those of its files
// (services/views/report/run_figures.hpp) once it is over, and while it lasts the same pictures of
// what there is, with plain means. The thread of the laboratory.
#pragma once

#include <string>
#include <vector>

#include "services/network/bench.hpp"
#include "services/views/figures/transfer_function.hpp"

namespace dyncal::inline views::live {

// Transfer function and deviations of the channel, then the sample clock of its source as far as it
// was reported; of the bench's current run also the interferometers, as their sources describe them
// now. Empty: the run has no result of this channel.
[[nodiscard]] std::vector<figures::Figure> run_figures(const network::Bench& bench,
                                                       const network::Run& run,
                                                       const std::string& channel,
                                                       figures::ErrorBars error_bars);

} // namespace dyncal::inline views::live
