// The sine of the excitation in the settled samples of a step (settled_samples.hpp), and what it
// leaves: to see that something is there and how clean it is. What the amplitude scatters by from
// block to block is in the uncertainties.
//
// Fails (no_source) with what analysis::fit_sine() refuses, in its words.
// Plain function; any thread.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/sine/sine_fit.hpp"
#include "services/base/error.hpp"
#include "services/views/signals/settled_samples.hpp"
#include "services/views/signals/trace.hpp"

namespace dyncal::inline views {

struct SineView {
  analysis::SineFit fit;
  std::int64_t phase_origin_ns = 0;
  double residual_rms = 0.0;
  std::vector<TraceColumn> columns;   // of the last four periods
  std::vector<TraceColumn> residuals; // of all that was fitted
};

inline constexpr std::size_t max_fitted_samples = std::size_t{1} << 15U;

[[nodiscard]] Expected<SineView> view_sine(const SettledSamples& settled, std::size_t columns);

} // namespace dyncal::inline views
