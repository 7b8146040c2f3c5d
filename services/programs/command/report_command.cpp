// `dyncal report RUN`: the report of a run as HTML and PDF. A draft, as often as one likes; with
// --issue a document: the result is held against store and recording (services/records/provenance),
// what speaks against it refuses it, and the PDF is entered under its number in the store.
//
// RUN is a run folder or a result file. Writes report.html and report.pdf into the run folder;
// for a file NAME.json, NAME-report.html and NAME-report.pdf beside it; or as --output says. Exit
// status 1 and one line when something is wrong; without weasyprint the HTML is written all the
// same. Belongs to one thread.
#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/issued_number.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/language_option.hpp"
#include "services/programs/command/named_sensor.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/provenance/result_provenance.hpp"
#include "services/views/document/pdf.hpp"
#include "services/views/document/report_document.hpp"
#include "services/views/report/amendments.hpp"

namespace dyncal::inline programs {
namespace {

struct ReportOptions {
  ReportRequest request;
  std::string output; // name without its ending; empty: as above
  bool no_pdf = false;
  bool issue = false;
  SensorOptions sensor;
  NumberOptions number;
};

void add_report(CLI::App& command, ReportOptions& report) {
  ReportRequest& request = report.request;
  take_run(command.add_option("RUN", request.run, "run folder, or a result file (JSON)"))
      ->required();
  command.add_option("--lab", request.laboratory, "laboratory file: letterhead, persons, texts");
  add_sensor_options(command, report.sensor);
  command.add_option("--tolerances", request.tolerances,
                     "tolerance file (default: what the sensor file has of it)");
  command.add_option("--channel", request.channels,
                     "channel to report (repeatable; default: all that respond)");
  command.add_option("--output", report.output,
                     "name of the files without .html and .pdf (default: report in the run "
                     "folder, NAME-report for NAME.json)");
  CLI::Option* no_pdf = command.add_flag("--no-pdf", report.no_pdf, "write the HTML alone");
  command
      .add_flag("--issue", report.issue,
                "issue it under its number, on the conditions of a certificate: the PDF alone "
                "(default: a draft)")
      ->excludes(no_pdf);
  add_language_option(command, request.languages);
  add_number_options(command, report.number);
  command.add_flag("--force", request.force,
                   "report in spite of what speaks against it; the first page says so");
}

Expected<void> write_and_name(const std::filesystem::path& path, std::string_view text) {
  DYNCAL_TRY(write_output_file(path, text));
  fmt::print("wrote {}\n", path.string());
  return {};
}

Expected<ReportContents> gather(const ReportOptions& report, const std::string& place,
                                const SharedWorkCount& count, const std::stop_token& stop) {
  ReportRequest request = report.request;
  request.number = report.number.number;
  request.replaces = report.number.replaces;
  request.is_draft = !report.issue;
  if (report.issue) {
    DYNCAL_TRY(const auto replaced, replaced_document(report.number, place, "PDF"));
    DYNCAL_TRY(request.held, read_held_result(request.run, place, count, stop));
    DYNCAL_TRY(require_proof(request.held));
  } else {
    DYNCAL_TRY(request.held.result, read_values(request.run));
    DYNCAL_TRY(auto journal, read_journal(request.run));
    add_journal(std::move(journal), request.held.result);
  }
  DYNCAL_TRY(request.sensor, sensor_of_run(report.sensor, request.held.result, place));
  return gather_report(request);
}

Expected<void> enter(const ReportContents& contents, const std::string& pdf,
                     const std::string& place, const std::filesystem::path& file) {
  IssuedDocument document = document_of(contents.result, pdf, file);
  document.number = contents.number;
  document.kind = "PDF";
  document.replaces = contents.replaces;
  document.serial = contents.sensor->serial;
  return enter_document(place, document);
}

Expected<void> run_report(const ReportOptions& report, const std::stop_token& stop) {
  const std::string stem = report.output.empty()
                               ? file_beside_run(report.request.run, "report").string()
                               : report.output;
  const std::string place = report.number.store.text_for(report.request.run);
  DYNCAL_TRY(const auto contents, with_progress("reading the run", [&](const auto& count) {
               return gather(report, place, count, stop);
             }));
  const std::string html = report_html(contents);
  if (report.no_pdf) {
    return write_and_name(stem + ".html", html);
  }
  if (!report.issue) {
    DYNCAL_TRY(write_and_name(stem + ".html", html));
  }
  DYNCAL_TRY(const auto pdf,
             with_progress("making the PDF", [&](const auto&) { return make_pdf(html); }));
  if (report.issue) {
    DYNCAL_TRY(enter(contents, pdf, place, stem + ".pdf"));
  }
  return write_and_name(stem + ".pdf", pdf);
}

const Command report_command{
    210, "report",
    "make a report of a stored run, HTML and PDF: values with U and k, figures, budgets, flags, "
    "conditions, signature block",
    add_report, run_report};

} // namespace
} // namespace dyncal::inline programs
