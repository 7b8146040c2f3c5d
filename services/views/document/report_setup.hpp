// The parts of a report that state what values were measured with: conditions, losses, sample
// clock, devices, corrections, software and hashes, recipe. HTML; any thread.
#pragma once

#include <string>

#include "services/views/document/report_contents.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string conditions_section(const ReportContents& contents);
[[nodiscard]] std::string losses_section(const ReportContents& contents);
[[nodiscard]] std::string closures_section(const ReportContents& contents);
[[nodiscard]] std::string clock_section(const ReportContents& contents);
[[nodiscard]] std::string devices_section(const ReportContents& contents);
[[nodiscard]] std::string software_section(const ReportContents& contents);
[[nodiscard]] std::string recipe_section(const ReportContents& contents);

} // namespace dyncal::inline views
