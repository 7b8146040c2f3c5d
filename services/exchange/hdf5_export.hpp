// Writes a recording as one HDF5 file from which `dyncal analyse` gives the same results
// (hdf5_import.hpp), in the layout of the public SmartUp receiver; README.md has the groups.
//
// Samples stand in columns, everything else as the messages that were recorded; a message that
// columns cannot hold exactly is kept as its bytes too. All of it or nothing takes the name. Fails
// (bad_file) with the file and the reason, such as a build without HDF5; (interrupted) when
// `progress` says so. One thread.
#pragma once

#include <filesystem>

#include "services/exchange/exported_recording.hpp"
#include "services/exchange/exported_runs.hpp"

namespace dyncal::services {

[[nodiscard]] Expected<void> export_hdf5(const ExportedRecording& recording,
                                         const ExportedRuns& runs, const std::filesystem::path& to,
                                         const ExportProgress& progress);

} // namespace dyncal::services
