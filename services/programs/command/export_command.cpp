// `dyncal export SOURCE --output TARGET`: a recording in a format of other programs
// (services/records/exchange/export_recording.hpp). Belongs to one thread.
#include <spdlog/spdlog.h>

#include <utility>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/exchange/export_recording.hpp"

namespace dyncal::inline programs {
namespace {

struct ExportCommand {
  ExportOptions options;
  std::string format; // empty: by the name of the target
};

void add_export(CLI::App& command, ExportCommand& exported) {
  ExportOptions& options = exported.options;
  take_run(command.add_option("SOURCE", options.recording, "folder of a run, or recording (.mcap)"))
      ->required();
  command
      .add_option("--output", options.to, "file to write, a folder for csv; nothing is overwritten")
      ->required();
  command.add_option("--format", exported.format,
                     "hdf5, npz, csv or mcap-rows (for PlotJuggler, Foxglove, Lichtblick); "
                     "default: by the name (.h5, .npz, .mcap, else csv)");
  command.add_option("--channel", options.channels,
                     "only this one, SOURCE/CHANNEL or SOURCE (repeatable; not for hdf5)");
}

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

Expected<void> run_export(ExportCommand& command, const std::stop_token& stop) {
  ExportOptions& options = command.options;
  DYNCAL_TRY(options.format, parse_export_format(command.format, options.to));
  const auto figures = with_progress("reading", [&](const SharedWorkCount& count) {
    options.count = count;
    options.stop = stop;
    bool exporting = false;
    return export_recording(options, [&](double share) {
      if (!std::exchange(exporting, true)) {
        count->begin_share("exporting");
      }
      count->set_share_done(share);
      return !stop.stop_requested();
    });
  });
  DYNCAL_TRY(figures);
  print(*figures, options.to);
  return {};
}

const Command export_command{
    160, "export",
    "a recording for other programs: HDF5, NumPy, CSV, or MCAP with one message a sample",
    add_export, run_export};

} // namespace
} // namespace dyncal::inline programs
