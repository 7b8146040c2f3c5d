// Writes the samples of a recording as tables (row_table.hpp):
//
// csv: a folder with one file a source and contents.json (exported_runs.hpp). The first line names
// the columns, with the unit of a channel behind its name in brackets; numbers are the shortest
// that give the same bits back, "nan" is not measured. dyncal reads them as source files.
// npz: numpy.load() gives a structured array a source and "contents_json" (bytes).
// mcap-rows: a channel a source with one message a sample, all numbers as float64, schema
// "ros2msg", which PlotJuggler, Foxglove and Lichtblick plot; its time is the sample's. A source
// with a time base of its own is shifted as a whole to when its first samples were received.
//
// All of it or nothing takes the name (services/base). Fails (bad_file) with the file and the
// reason, (interrupted) when `progress` says so. One thread.
#pragma once

#include <filesystem>

#include "services/records/exchange/row_table.hpp"

namespace dyncal::inline records {

struct RowExport {
  const std::vector<RowTable>& tables;
  std::string contents; // contents_json()
  std::filesystem::path to;
  const ExportProgress& progress;
};

[[nodiscard]] Expected<void> export_csv(const RowExport& wanted);
[[nodiscard]] Expected<void> export_npz(const RowExport& wanted);
[[nodiscard]] Expected<void> export_mcap_rows(const RowExport& wanted);

// For each of the formats: calls `visit` with the rows of a table and counts them for `progress`,
// which goes from 0.2 to 1.
class RowProgress {
public:
  explicit RowProgress(const RowExport& wanted);
  [[nodiscard]] Expected<void> for_each(const RowTable& table,
                                        const std::function<Expected<void>(const Rows&)>& visit);

private:
  const ExportProgress& progress_;
  std::uint64_t all_ = 0;
  std::uint64_t done_ = 0;
};

} // namespace dyncal::inline records
