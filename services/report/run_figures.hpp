// The figures of a run as files: magnitude and phase over frequency for every channel that
// responds, and for the sample clock the histogram of intervals, intervals over temperature and
// over time (paper figures 5 to 9), each as SVG and CSV. Any thread.
#pragma once

#include <filesystem>
#include <vector>

#include "services/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::services {

// Fails (bad_file) when a file cannot be written.
[[nodiscard]] Expected<std::vector<std::filesystem::path>>
write_figures(const RunOutcome& outcome, const std::filesystem::path& folder);

} // namespace dyncal::services
