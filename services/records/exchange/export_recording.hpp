// A recording in the formats of other programs: which one is asked for, and all of it from the
// recording to the finished file.
//
// Fails (bad_argument) for a format or channel that there is not, (bad_file) as reading and writing
// do, (interrupted) when `progress` says so. One thread.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "services/records/exchange/exported_recording.hpp"

namespace dyncal::inline records {

enum class ExportFormat { hdf5, npz, csv, mcap_rows };

// "hdf5", "npz", "csv" or "mcap-rows"; where it is empty by the name of the target.
[[nodiscard]] Expected<ExportFormat> parse_export_format(const std::string& name,
                                                         const std::filesystem::path& to);

struct ExportOptions {
  std::filesystem::path recording; // as open_recording() takes it
  std::filesystem::path to;
  ExportFormat format = ExportFormat::hdf5;
  std::vector<std::string> channels; // as row_tables() takes them
  // Of what is read before `progress` is asked:
  SharedWorkCount count{};
  std::stop_token stop{};
};

struct ExportedFigures {
  struct Source {
    std::string name;
    std::size_t channels = 0;
    std::size_t sessions = 0;
    std::uint64_t samples = 0;
    std::uint64_t lost = 0;
    std::uint64_t left_out = 0; // blocks or records whose sizes contradict each other
  };
  std::vector<Source> sources;
  std::vector<std::string> warnings; // what is damaged in the recording
};

[[nodiscard]] Expected<ExportedFigures> export_recording(const ExportOptions& wish,
                                                         const ExportProgress& progress);

} // namespace dyncal::inline records
