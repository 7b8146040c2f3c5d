// A run of a recording evaluated again as the analysis service evaluated it live: the same samples,
// so the same results, bit for bit; also those of steps that the live analysis never saw.
//
// What was recorded is handed to the evaluation in the order of the file, samples of each source in
// the order of their numbers (recording_index.hpp). Samples count from the source's answer to the
// run on. What the conductor announced counts once the samples that it is about have come
// (waiting_announcements.hpp). The report on the sample clock covers what the live one covered.
// Results take the way of the contract's messages, as live ones do.
//
// With another recipe the same samples are evaluated by that one. Fails (bad_file) as
// index_recording(), and as RunEvaluator::describe(). Whatever is damaged or missing in the file is
// in `warnings` and, as lost samples, in the results. Blocks; evaluates steps in threads of its
// own.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records {

struct RecordedRunOptions {
  std::string run;              // empty: the one that is there
  std::optional<Recipe> recipe; // another one than the recorded
  SharedWorkCount count{};      // of megabytes read, then of its steps and results
  bool whole_or_none = false;   // a stop makes it fail (interrupted), not give what there is
};

struct RecordedRunOutcome {
  RunOutcome outcome;
  std::uint64_t live_results = 0; // that the live analysis gave
  bool source_restarted = false;  // one of the recipe's, within the recording
  std::vector<std::string> warnings;
};

[[nodiscard]] Expected<RecordedRunOutcome> evaluate_recording(recording::RecordingReader& reader,
                                                              const RecordedRunOptions& wish,
                                                              const std::stop_token& stop);

} // namespace dyncal::inline records
