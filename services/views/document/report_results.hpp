// The parts of a report that state values: tables with U and k, figures, budgets, flags, single
// results. HTML; any thread.
#pragma once

#include <string>

#include "services/views/document/report_contents.hpp"

namespace dyncal::inline views {

// Table, figure, group delay and budget of one channel; `figure` numbers the SVG of the document.
[[nodiscard]] std::string channel_section(const ReportContents& contents,
                                          const std::string& channel, std::size_t figure);
// Channels of the run that are not shown in full.
[[nodiscard]] std::string other_channels(const ReportContents& contents);
[[nodiscard]] std::string flag_section(const ReportContents& contents);
[[nodiscard]] std::string single_results(const ReportContents& contents);

} // namespace dyncal::inline views
