// The means over repetitions of one channel, one for each frequency and level, from its single
// results (analysis/method/repetitions.hpp). Equal results give equal bits, whoever takes the mean:
// the analysis of a run, or who holds a published mean against what it must be of. Any thread.
#pragma once

#include <vector>

#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

// Ordered by frequency and level; phases within (-pi, pi]. `results`: valid ones of one channel. A
// point of which no mean can be taken is left out.
[[nodiscard]] std::vector<FrequencyPoint>
mean_points(const std::vector<const StepResult*>& results);

} // namespace dyncal::inline evaluation
