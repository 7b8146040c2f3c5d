// What the shots of a step show beside their value: end stops and distortion of series and traces,
// lines beside the excitation, and whether the shots are repetitions of one measurement.
//
// Plain functions, any thread.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/method/series_stamping.hpp"
#include "analysis/step/peak_shape.hpp"
#include "services/evaluation/method/signal_check.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/record/shot_record.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/result/channel_lines.hpp"

namespace dyncal::inline evaluation {

struct CheckedShots {
  const StepTask& task;
  const SourceRecord& oscilloscope; // for their descriptions
  const SourceRecord& sensor;
  const std::vector<ShotRecord::Shot>& shots; // at least one
  const analysis::SeriesStampingResult& evaluated;
};

// Of the series of one channel, and of the traces of sync. The first shot in which something is
// found speaks for the step, or else the very first. Traces carry phase only: nothing refuses them;
// but one that is shorter than a period of sync cannot be judged.
// `shapes` gets what those shots show that were looked at (shape_check.hpp).
[[nodiscard]] SignalCheck check_series(const CheckedShots& checked, const ChannelName& channel,
                                       std::size_t column,
                                       std::vector<analysis::SineShape>& shapes);
[[nodiscard]] SignalCheck check_traces(const CheckedShots& checked, const ChannelName& sync);

// What every shot shows of the lines, of which none may tell any from the excitation.
[[nodiscard]] ChannelLines lines_of_series(const CheckedShots& checked, const ChannelName& channel,
                                           std::size_t column);

// A flag where the shots of a channel differ by more than their noise, or change within themselves.
[[nodiscard]] std::vector<Flag> flags_of_agreement(const analysis::SeriesChannelResult& channel);

} // namespace dyncal::inline evaluation
