// The parts of a report that say whose it is and what it is about: letterhead, summary, remarks,
// signatures. HTML; any thread.
#pragma once

#include <string>

#include "services/views/document/report_contents.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string letterhead(const ReportContents& contents);
// What a reader must know before any number: a run that was broken off, values that are missing.
[[nodiscard]] std::string warnings(const ReportContents& contents);
[[nodiscard]] std::string summary(const ReportContents& contents);
[[nodiscard]] std::string remarks(const ReportContents& contents);
[[nodiscard]] std::string signatures(const ReportContents& contents);

// The title, also that of the window and of the PDF.
[[nodiscard]] std::string title_of(const ReportContents& contents);
// "Physics laboratory, Musterstadt", or the bench without a laboratory file.
[[nodiscard]] std::string issuer_of(const ReportContents& contents);

} // namespace dyncal::inline views
