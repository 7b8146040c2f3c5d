// Compares the results of a demo with the truth of the virtual bench: the only place that reads the
// truth file, after the run is over.
//
// The deviation of a point is compared with its own standard uncertainty; for the phase after
// taking out whole turns. Plain functions, any thread.
#pragma once

#include <filesystem>
#include <string>

#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline programs {

struct TruthCheck {
  std::size_t points = 0;  // transfer function values compared, magnitude and phase each counted
  double worst = 0.0;      // largest |deviation| / u
  std::string worst_where; // "dau/acceleration_z, 40 Hz, phase"
};

// Fails (bad_file) when the truth file cannot be read or lacks an excited channel that the run has
// no result for.
[[nodiscard]] Expected<TruthCheck> check_truth(const RunOutcome& outcome,
                                               const std::filesystem::path& truth_file);

} // namespace dyncal::inline programs
