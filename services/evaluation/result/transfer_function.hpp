// The transfer function of one channel over all steps of a run: means over repetitions, and the
// group delay. Plain data; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/method/repetitions.hpp"
#include "analysis/response/group_delay.hpp"
#include "services/contract/evaluation_method.hpp"
#include "services/evaluation/result/closure.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

struct FrequencyPoint {
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0; // as planned
  analysis::RepetitionMean mean;
  double unwrapped_phase_rad = 0.0;
};

struct TransferFunction {
  std::string channel; // "source/channel"
  EvaluationMethod method = EvaluationMethod::sample_timestamping;
  std::string unit;         // D-SI, output per input
  std::string excited_axis; // empty: not stated
  std::vector<FrequencyPoint> points;
  // Through one point a frequency (delay_points.hpp).
  std::optional<analysis::GroupDelay> group_delay;
  std::string group_delay_problem; // why there is none
  std::vector<Closure> closures;   // in the order of ClosureKind; at the end of a run
  std::vector<Flag> flags;
  std::uint64_t lost = 0; // samples, over all valid results
};

} // namespace dyncal::inline evaluation
