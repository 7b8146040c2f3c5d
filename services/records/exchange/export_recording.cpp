#include "services/records/exchange/export_recording.hpp"

#include <fmt/core.h>

#include "services/base/output_stream.hpp"
#include "services/records/exchange/exported_runs.hpp"
#include "services/records/exchange/hdf5_export.hpp"
#include "services/records/exchange/opened_recording.hpp"
#include "services/records/exchange/row_formats.hpp"

namespace dyncal::inline records {
namespace {

Expected<void> write(const ExportOptions& wish, const ExportedRecording& recording,
                     const ExportedRuns& runs, const ExportProgress& progress) {
  if (wish.format == ExportFormat::hdf5) {
    return export_hdf5(recording, runs, wish.to, progress);
  }
  DYNCAL_TRY(const auto tables, row_tables(recording, wish.channels));
  const RowExport rows{tables, contents_json(recording, runs), wish.to, progress};
  switch (wish.format) {
  case ExportFormat::npz:
    return export_npz(rows);
  case ExportFormat::csv:
    return export_csv(rows);
  default:
    return export_mcap_rows(rows);
  }
}

ExportedFigures figures_of(const ExportedRecording& recording, std::vector<std::string> warnings) {
  ExportedFigures figures;
  for (const ExportedSource& source : recording.sources()) {
    figures.sources.push_back({source.name, source.channels.size(), source.sessions.size(),
                               source.samples, source.lost, source.left_out});
  }
  figures.warnings = std::move(warnings);
  for (const recording::Damage& damage : recording.contents().report.damages) {
    figures.warnings.push_back(to_string(damage, recording.reader().path()));
  }
  return figures;
}

} // namespace

Expected<ExportFormat> parse_export_format(const std::string& name,
                                           const std::filesystem::path& to) {
  const std::string suffix = to.extension().string();
  if (name == "hdf5" || (name.empty() && (suffix == ".h5" || suffix == ".hdf5"))) {
    return ExportFormat::hdf5;
  }
  if (name == "npz" || (name.empty() && suffix == ".npz")) {
    return ExportFormat::npz;
  }
  if (name == "mcap-rows" || (name.empty() && suffix == ".mcap")) {
    return ExportFormat::mcap_rows;
  }
  if (name == "csv" || (name.empty() && (suffix.empty() || suffix == ".csv"))) {
    return ExportFormat::csv;
  }
  return fail(ErrorCode::bad_argument,
              name.empty()
                  ? fmt::format("{}: its name tells no format (.h5, .npz, .mcap, or a "
                                "folder for csv): name one with --format",
                                to.string())
                  : fmt::format("unknown format '{}'; there are: hdf5, npz, csv, mcap-rows", name));
}

Expected<ExportedFigures> export_recording(const ExportOptions& wish,
                                           const ExportProgress& progress) {
  if (wish.format == ExportFormat::hdf5 && !wish.channels.empty()) {
    return fail(ErrorCode::bad_argument,
                "--channel is for csv, npz and mcap-rows: an HDF5 file holds the whole recording");
  }
  const bool is_folder = wish.format == ExportFormat::csv;
  DYNCAL_TRY(is_folder ? Expected<void>{} : check_new_output(wish.to));
  DYNCAL_TRY(auto opened, open_recording(wish.recording, wish.count, wish.stop));
  DYNCAL_TRY(const auto recording,
             ExportedRecording::open(opened.reader, progress, wish.count, wish.stop));
  DYNCAL_TRY(const auto runs, read_runs(opened.reader));
  return write(wish, recording, runs, progress).map([&] {
    return figures_of(recording, std::move(opened.warnings));
  });
}

} // namespace dyncal::inline records
