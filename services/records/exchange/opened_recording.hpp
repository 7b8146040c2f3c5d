// A recording to read, in whichever form it is there: a file (.mcap), or the folder of a run, with
// all the recordings of a run that was resumed as one.
//
// Fails (bad_file) with the file and what is wrong with it. One thread.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records {

struct OpenedRecording {
  recording::RecordingReader reader;
  std::vector<std::string> warnings; // of what it was made from
};

// By its name, or, of a folder, by what is in it.
[[nodiscard]] bool is_recording(const std::filesystem::path& path);

// `count`: of what is read, where it is not used as it is. Fails (interrupted) if a stop was
// requested meanwhile.
[[nodiscard]] Expected<OpenedRecording> open_recording(const std::filesystem::path& path,
                                                       const SharedWorkCount& count = nullptr,
                                                       const std::stop_token& stop = {});

} // namespace dyncal::inline records
