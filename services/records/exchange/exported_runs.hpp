// What a recording says of its runs beside the samples: when each step was excited, what the live
// analysis found, what the recorder lost; and all of it with the sources as a text (JSON) that goes
// with every format. One thread.
#pragma once

#include <string>
#include <vector>

#include "services/records/exchange/exported_recording.hpp"

namespace dyncal::inline records {

struct ExportedRuns {
  std::vector<wire::Excitation> excitations;     // the newest of every step and attempt
  std::vector<wire::CalibrationResult> results;  // the newest of every value
  std::vector<wire::TransferFunction> functions; // the newest of every channel
  std::vector<recording::Metadata> metadata;
  std::vector<recording::Attachment> attachments;
};

// Fails (bad_file) as reading does.
[[nodiscard]] Expected<ExportedRuns> read_runs(recording::RecordingReader& reader);

// The step's frequency; NaN where its text is no number.
[[nodiscard]] double frequency_of(const wire::Excitation& excitation);

[[nodiscard]] std::string contents_json(const ExportedRecording& recording,
                                        const ExportedRuns& runs);

} // namespace dyncal::inline records
