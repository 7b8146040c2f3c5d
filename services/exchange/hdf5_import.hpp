// Reads an HDF5 file that dyncal exported back as the recording it was made of: the same messages,
// bit for bit and in their order, with its attachments.
//
// Nothing is handed over before all of it is read: the CRC-32 of the file and the SHA-256 over its
// messages must fit. Fails (bad_file) with the file and what is wrong with it; a file that is not
// dyncal's, such as one of the public receiver, is refused with where it can be used. What was
// damaged in the recording before the export is in `warnings`. One thread.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "services/error.hpp"
#include "services/recording/recording_reader.hpp"
#include "services/work_count.hpp"

namespace dyncal::services {

struct ImportedRecording {
  recording::RecordingReader reader;
  std::vector<std::string> warnings;
};

// By its name: .h5, .hdf5
[[nodiscard]] bool is_hdf5(const std::filesystem::path& path);

// `count`: of its messages. Fails (interrupted) if a stop was requested meanwhile.
[[nodiscard]] Expected<ImportedRecording> import_hdf5(const std::filesystem::path& path,
                                                      const SharedWorkCount& count = nullptr,
                                                      const std::stop_token& stop = {});

} // namespace dyncal::services
