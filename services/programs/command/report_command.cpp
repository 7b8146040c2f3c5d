// `dyncal report RUN`: the report of a run as HTML and PDF.
//
// RUN is a run folder or a result file. Writes report.html and report.pdf into the run folder;
// for a file NAME.json, NAME-report.html and NAME-report.pdf beside it; or as --output says. Exit
// status 1 and one line when something is wrong; without weasyprint the HTML is written all the
// same. Belongs to one thread.
#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/document/pdf.hpp"
#include "services/views/document/report_document.hpp"

namespace dyncal::inline programs {
namespace {

struct ReportOptions {
  ReportRequest request;
  std::string output; // name without its ending; empty: as above
  bool no_pdf = false;
};

void add_report(CLI::App& command, ReportOptions& report) {
  ReportRequest& request = report.request;
  take_run(command.add_option("RUN", request.run, "run folder, or a result file (JSON)"))
      ->required();
  command.add_option("--lab", request.laboratory, "laboratory file: letterhead, persons, texts");
  command.add_option("--sensor", request.sensor, "sensor file: what was calibrated, and for whom");
  command.add_option("--channel", request.channels,
                     "channel to report (repeatable; default: all that respond)");
  command.add_option("--output", report.output,
                     "name of the files without .html and .pdf (default: report in the run "
                     "folder, NAME-report for NAME.json)");
  command.add_flag("--no-pdf", report.no_pdf, "write the HTML alone");
  command.add_flag("--force", request.force,
                   "report although a closure is open; the first page says so");
}

Expected<void> write_and_name(const std::filesystem::path& path, std::string_view text) {
  DYNCAL_TRY(write_output_file(path, text));
  fmt::print("wrote {}\n", path.string());
  return {};
}

Expected<std::string> make_html(const ReportRequest& request, const SharedWorkCount& count) {
  DYNCAL_TRY(const auto contents, gather_report(request));
  count->begin("making the report", "", 0);
  return report_html(contents);
}

Expected<void> run_report(const ReportOptions& report) {
  const std::string stem = report.output.empty()
                               ? file_beside_run(report.request.run, "report").string()
                               : report.output;
  DYNCAL_TRY(const auto html, with_progress("reading the run", [&](const auto& count) {
               return make_html(report.request, count);
             }));
  DYNCAL_TRY(write_and_name(stem + ".html", html));
  if (report.no_pdf) {
    return {};
  }
  DYNCAL_TRY(const auto pdf,
             with_progress("making the PDF", [&](const auto&) { return make_pdf(html); }));
  return write_and_name(stem + ".pdf", pdf);
}

const Command report_command{
    210, "report",
    "make a report of a stored run, HTML and PDF: values with U and k, figures, budgets, flags, "
    "conditions, signature block",
    add_report, run_report};

} // namespace
} // namespace dyncal::inline programs
