// At the end of a run its own recording is evaluated once more, as `dyncal analyse FOLDER` does
// (replay/recorded_run.hpp), and what came live is held against that
// (evaluation/outcome_agreement.hpp): samples of another run, another recipe and results of
// somebody else show there.
//
// Everything of the run is kept and shown before, and its bench is free. It takes at most a tenth
// of the run's time, or `least_limit`, whichever is longer; then it is given up, which is said. Of
// a recording that is not whole, of a run that was resumed, whose program died with what it had not
// written yet, and where a source restarted, values may be missing or of fewer samples: they are
// counted, and not taken for differences. Evaluates in threads of its own, and waits for them.
#pragma once

#include <chrono>
#include <filesystem>
#include <stop_token>
#include <string>

#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline programs {

struct OwnRecordingCheck {
  std::string sentence; // one line, whatever came out
  bool differs = false;
};

inline constexpr std::chrono::seconds least_limit{10}; // a short run may be busy to its end

// `may_lack`: the recording is not whole, or the run was resumed.
[[nodiscard]] OwnRecordingCheck check_own_recording(const RunOutcome& outcome,
                                                    const std::filesystem::path& run_folder,
                                                    bool may_lack, const std::stop_token& stop);

// Of a run that is not held against its recording.
[[nodiscard]] std::string not_held(const std::string& reason);

} // namespace dyncal::inline programs
