// One sine approximation of a recorded series whose stamps may be at fault: what `dyncal fit` does
// with a file, and dyncal.fit_record() in Python with arrays.
//
//   y_j(t) = A_j sin(w (t - t_0)) + B_j cos(w (t - t_0)) + C_j + what `basis` has beside it
//
// 1. Without a frequency it is estimated (frequency_estimate.hpp), good to 1.5 bins 1/T, and then
//    fitted, shared by all columns.
// 2. The sine is fitted alone, or beside drift, harmonics and lines (extended_sine_fit.hpp).
// 3. What scatter of the stamps took off an amplitude is put back where it is more than a tenth of
//    its uncertainty (stamp_scatter.hpp); `shortening_rel` says how much that was.
// 4. What errors of the stamps in step with the sine may do to it widens the covariance
//    (stamp_beat.hpp).
//
// Units and sign as sine_fit.hpp. Fails as frequency_estimate.hpp, sine_fit.hpp and
// extended_sine_fit.hpp do. Any thread; `begin` is called in it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/base/progress.hpp"
#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

struct RecordFitSettings {
  std::optional<Frequency> frequency{}; // empty: estimated
  ExtendedBasis basis{};
  std::optional<std::int64_t> phase_origin_ns{}; // empty: the first stamp
};

struct RecordFit {
  Frequency frequency = Frequency::from_hz(1.0); // until it is known
  std::optional<double> u_frequency_hz{};        // where it was fitted
  std::int64_t phase_origin_ns = 0;
  std::vector<SineFit> fits{};          // in the order of the columns
  std::vector<double> shortening_rel{}; // put back, for each of them; 0: nothing to be seen
};

// Called when a stage of the work begins ("fitting"), for what is told of its share.
using RecordFitStages = std::function<Progress(std::string_view stage)>;

[[nodiscard]] Expected<RecordFit> fit_record(const RecordFitSettings& settings,
                                             std::span<const std::int64_t> stamps_ns,
                                             std::span<const std::span<const double>> columns,
                                             const RecordFitStages& begin = {});

} // namespace dyncal::analysis
