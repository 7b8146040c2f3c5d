// The recording of a run evaluated once more, held against the result file of the run.
//
// The version that made the result gives the same file to the last bit, but for the statistics of
// sample clocks, which end where the live analysis stopped to listen, and for the instants at which
// the conductor began, paused and ended, which may differ by 10 s. Another version may give what
// differs by up to 0.1 u, in values, in U and in the group delay; a flag, or a closure that is
// open, must be in the file as well. A value for which the recording has fewer samples than the
// analysis had cannot be held against it: it is missing, and means are then held against the single
// results alone (views/report/mean_check.hpp). The values that are there are then held within 0.1
// u, for their clocks are known from less, and their U not at all: what all steps show goes into
// each.
//
// Fails (no_result) where the two differ, naming the first difference, or where the recording is of
// other runs; (bad_file) where it cannot be read; (interrupted). Evaluates in threads of its own.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stop_token>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline records {

struct RepeatedEvaluation {
  std::size_t values = 0;  // single ones of the file
  std::size_t missing = 0; // of them, see above
  bool is_same_version = false;
  double largest_deviation_u = 0.0; // of another version, or where some are missing; in u
};

[[nodiscard]] Expected<RepeatedEvaluation> repeat_evaluation(const StoredResult& result,
                                                             const std::filesystem::path& recording,
                                                             const SharedWorkCount& count,
                                                             const std::stop_token& stop);

// The same for a result of another evaluation. The files are named in sentences.
[[nodiscard]] Expected<RepeatedEvaluation> hold_against(const StoredResult& kept,
                                                        const StoredResult& again);

} // namespace dyncal::inline records
