// What only reference and sensor together show of a step: peaks that are bent in one of the two
// (analysis/step/peak_shape.hpp), stamps that scatter (analysis/sine/stamp_scatter.hpp), values
// that are not of the instants of their stamps (analysis/step/held_values.hpp).
//
//   peaks_bent         the amplitude is wrong by more than half its u, and by 5 u of that finding;
//                      of both channels where their shapes do not tell which it is
//   over_range         single samples jump by more than the amplitude at the peaks
//   stamps_scatter     the amplitude was corrected by more than its u
//   values_off_stamps  values are held so often that it moves the phase by a tenth of its u; a
//                      fifth of the stamps follow the one before at once, as when a buffer is
//                      read; or some values, or every second one, are beside the sine of the others
//
// Refused: bent by more than a hundredth, or shortened by scatter to less than nine tenths. Appends
// to flags and, as signal_check.hpp, takes a refused value away. Plain functions, any thread.
#pragma once

#include <span>
#include <string>

#include "analysis/method/transfer_point.hpp"
#include "analysis/step/peak_shape.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// `result` has its value and u; `is_differentiated`: the response is per another quantity than that
// of the reference's samples. Channels without integrity are not judged.
void check_shape(const analysis::ChannelFit& reference, bool is_differentiated,
                 const analysis::ChannelFit& sensor, StepResult& result);

// Bent peaks of a triggered series, by the mean shape of its shots.
void check_shape_of_shots(const analysis::ChannelFit& reference, bool is_differentiated,
                          const std::string& channel, std::span<const analysis::SineShape> shots,
                          StepResult& result);

} // namespace dyncal::inline evaluation
