// The report of a run as one HTML file that needs nothing else: no network, no script, no font; its
// figures are drawn by services/views/figures and stand in it as SVG. The PDF is made of the same
// file (pdf.hpp).
//
// In order: letterhead and summary, values with U and k, figures, flags, uncertainty budget,
// conditions, losses, sample clock, signatures; annexes: devices, corrections, software and hashes,
// budgets, single results, recipe. In several languages they follow each other in one document,
// each whole. Whatever comes from a file is escaped.
//
// Fails (bad_file) when the result file lacks a key; (bad_argument) when a channel that was asked
// for has no value, when a closure of a channel is open and the report is not forced, and when
// something speaks against one that is to be issued (services/views/objections). Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/views/document/report_sections.hpp"
#include "services/views/objections/held_result.hpp"

namespace dyncal::inline views {

struct ReportRequest {
  std::filesystem::path run;          // a run folder or a result file
  std::filesystem::path laboratory;   // empty: no letterhead
  std::optional<SensorFile> sensor{}; // nothing: what the run knows of it
  std::filesystem::path tolerances;   // empty: those of the sensor file, if any
  std::vector<std::string> channels;  // empty: all that respond
  bool force = false;                 // in spite of all that speaks against it, which it says
  HeldResult held{};                  // that is reported
  bool is_draft = true;               // of the result as it is
  std::string number;                 // empty: that of the sensor file, if any
  std::string replaces;
  std::vector<Language> languages; // empty: as the laboratory file says, else English
};

// Reads all files that a report is made of.
[[nodiscard]] Expected<ReportContents> gather_report(const ReportRequest& request);

[[nodiscard]] std::string report_html(const ReportContents& contents);

} // namespace dyncal::inline views
