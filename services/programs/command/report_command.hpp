// `dyncal report RUN`: the report of a run as HTML and PDF.
//
// RUN is a run folder or a result file. Writes report.html and report.pdf into the run folder;
// for a file NAME.json, NAME-report.html and NAME-report.pdf beside it; or as --output says. Exit
// status 1 and one line when something is wrong; without weasyprint the HTML is written all the
// same. Belongs to one thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace dyncal::inline programs {

struct ReportCommand {
  std::filesystem::path run;
  std::filesystem::path laboratory;  // empty: none
  std::filesystem::path sensor;      // empty: none
  std::filesystem::path output;      // name without its ending; empty: as above
  std::vector<std::string> channels; // empty: all that respond
  bool no_pdf = false;
  bool force = false;
};

[[nodiscard]] int run_report(const ReportCommand& command);

} // namespace dyncal::inline programs
