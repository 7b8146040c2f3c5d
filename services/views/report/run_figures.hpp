// The figures of a run: for every channel that responds magnitude and phase over frequency, and how
// far the repetitions are from their mean; for the sample clock the histogram of intervals,
// intervals over temperature and over time (paper figures 5 to 9); for an interferometer its
// ellipse and what that leaves. As files, each is SVG and CSV. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/figures/transfer_function.hpp"

namespace dyncal::inline views {

struct FigureFiles {
  std::optional<std::filesystem::path> folder; // empty: none are written
  figures::ErrorBars error_bars = figures::ErrorBars::standard;
};

[[nodiscard]] std::vector<figures::Figure> run_figures(const RunOutcome& outcome,
                                                       figures::ErrorBars error_bars);
// Those of one channel, whether it responds or not.
[[nodiscard]] std::vector<figures::Figure>
channel_figures(const figures::TransferFunctionData& data, const std::string& channel);
// Those of one source; none of a source whose samples have no stamps.
[[nodiscard]] std::vector<figures::Figure> clock_figures(const RunOutcome& outcome,
                                                         const ClockReport& report);
// Of every displacement that the source makes of quadrature signals, as it described them last.
[[nodiscard]] std::vector<figures::Figure>
interferometer_figures(const RunOutcome& outcome, const std::string& source,
                       const drivers::SourceDescription& description);

// Fails (bad_file) when a file cannot be written.
[[nodiscard]] Expected<std::vector<std::filesystem::path>>
write_figures(const RunOutcome& outcome, const std::filesystem::path& folder,
              figures::ErrorBars error_bars = figures::ErrorBars::standard);

} // namespace dyncal::inline views
