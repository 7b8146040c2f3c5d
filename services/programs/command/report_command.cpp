#include "services/programs/command/report_command.hpp"

#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/document/pdf.hpp"
#include "services/views/document/report_document.hpp"

namespace dyncal::inline programs {
namespace {

std::filesystem::path stem_of(const ReportCommand& command) {
  if (!command.output.empty()) {
    return command.output;
  }
  std::error_code unknown;
  return std::filesystem::is_directory(command.run, unknown)
             ? command.run / "report"
             : command.run.parent_path() / (command.run.stem().string() + "-report");
}

std::filesystem::path with_ending(std::filesystem::path stem, const std::string& ending) {
  stem += ending;
  return stem;
}

Expected<void> write_and_name(const std::filesystem::path& path, std::string_view text) {
  auto written = write_output_file(path, text);
  if (written) {
    fmt::print("wrote {}\n", path.string());
  }
  return written;
}

Expected<void> make_report(const ReportCommand& command) {
  const std::filesystem::path html_file = with_ending(stem_of(command), ".html");
  const std::filesystem::path pdf_file = with_ending(stem_of(command), ".pdf");
  const auto html = [&]() -> Expected<std::string> {
    const WorkProgress progress("reading the run");
    DYNCAL_TRY(const auto contents, gather_report({.run = command.run,
                                                   .laboratory = command.laboratory,
                                                   .sensor = command.sensor,
                                                   .channels = command.channels,
                                                   .force = command.force}));
    progress.count()->begin("making the report", "", 0);
    return report_html(contents);
  }();
  DYNCAL_TRY(html);
  if (auto written = write_and_name(html_file, *html); !written || command.no_pdf) {
    return written;
  }
  const auto pdf = [&] {
    const WorkProgress progress("making the PDF");
    return make_pdf(*html);
  }();
  return pdf ? write_and_name(pdf_file, *pdf) : fail(pdf.error());
}

} // namespace

int run_report(const ReportCommand& command) {
  const auto made = make_report(command);
  return made ? 0 : report_error(made.error());
}

} // namespace dyncal::inline programs
