// The shots of a step as the evaluation takes them: of one form, with a digest and a summary of
// their samples.
//
// Plain functions, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/record/shot_record.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/result/result_flag.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// Those whose series have the length and the rate that most have, and whose records have the
// channels; a flag names how many were left out.
[[nodiscard]] std::vector<ShotRecord::Shot>
shots_of_usual_length(const std::vector<ShotRecord::Shot>& shots, std::size_t series_channels,
                      std::size_t trace_channels, std::vector<Flag>& flags);

// SHA-256 of all samples that a step is evaluated from.
[[nodiscard]] std::string digest_of_shots(const StepSamples& acs,
                                          const std::vector<ShotRecord::Shot>& shots);

// Of the traces or of the series. REQUIRES: at least one shot.
[[nodiscard]] SourceSamples summary_of_shots(const SourceRecord& source,
                                             const std::vector<ShotRecord::Shot>& shots,
                                             const TriggeredRecord* ShotRecord::Shot::*record,
                                             const ShotRecord::Loss& loss);

} // namespace dyncal::inline evaluation
