// Writes the samples, steps and results of a recording as one HDF5 file, in the layout of the
// public SmartUp receiver; README.md has the groups.
//
// All of it or nothing takes the name. Fails
// (bad_file) with the file and the reason, such as a build without HDF5; (interrupted) when
// `progress` says so. One thread.
#pragma once

#include <filesystem>

#include "services/records/exchange/exported_recording.hpp"
#include "services/records/exchange/exported_runs.hpp"

namespace dyncal::inline records {

[[nodiscard]] Expected<void> export_hdf5(const ExportedRecording& recording,
                                         const ExportedRuns& runs, const std::filesystem::path& to,
                                         const ExportProgress& progress);

} // namespace dyncal::inline records
