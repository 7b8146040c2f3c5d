#include "services/programs/command/export_command.hpp"

#include <utility>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/base/printable_text.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/share_line.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/exchange/export_recording.hpp"

namespace dyncal::inline programs {
namespace {

void print(const ExportedFigures& figures, const std::filesystem::path& to) {
  for (const std::string& warning : figures.warnings) {
    spdlog::warn("{}", warning);
  }
  for (const ExportedFigures::Source& source : figures.sources) {
    fmt::print("{}: {} channels, {} samples, {} lost, {} session{}\n", one_line(source.name),
               source.channels, source.samples, source.lost, source.sessions,
               source.sessions == 1 ? "" : "s");
    if (source.left_out > 0) {
      spdlog::warn("source '{}': {} blocks were left out, their sizes contradict each other",
                   source.name, source.left_out);
    }
  }
  fmt::print("wrote {}\n", to.string());
}

Expected<ExportedFigures> export_with_progress(const ExportCommand& command, ExportFormat format,
                                               const std::stop_token& stop) {
  const WorkProgress progress("reading");
  ShareLine line(stderr);
  bool exporting = false;
  return export_recording({.recording = command.recording,
                           .to = command.to,
                           .format = format,
                           .channels = command.channels,
                           .count = progress.count(),
                           .stop = stop},
                          [&](double share) {
                            if (!std::exchange(exporting, true)) {
                              progress.count()->begin_share("exporting");
                            }
                            progress.count()->set_share_done(share);
                            line.show(share);
                            return !stop.stop_requested();
                          });
}

} // namespace

int run_export(const ExportCommand& command, const std::stop_token& stop) {
  const auto format = parse_export_format(command.format, command.to);
  if (!format) {
    return report_error(format.error());
  }
  const auto figures = export_with_progress(command, *format, stop);
  if (!figures) {
    return report_error(figures.error());
  }
  print(*figures, command.to);
  return 0;
}

} // namespace dyncal::inline programs
