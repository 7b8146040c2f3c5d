// What a fitted model leaves of a measured response, as a picture: magnitude above, phase below;
// on the left in per cent and degrees with bars of each value's own u and the band of u with what
// all values have in common, on the right in u of each value.
//
// On the right the most probable errors that all values have in common are taken out; when the
// model fits, 95 % of the points lie within +-2. The CSV holds all numbers, phases in rad.
#pragma once

#include <string>
#include <vector>

#include "services/views/figures/figure.hpp"

namespace dyncal::inline views::figures {

struct ModelResidual { // measured - model
  double frequency_hz = 0.0;
  double magnitude_rel = 0.0;
  double u_magnitude_rel = 0.0;     // with what is common
  double u_own_magnitude_rel = 0.0; // without
  double own_magnitude_rel = 0.0;   // residual without what is common
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
  double u_own_phase_rad = 0.0;
  double own_phase_rad = 0.0;
};

struct ModelResidualData {
  std::string title{};
  std::string subtitle{};
  std::vector<ModelResidual> residuals{}; // by frequency
  std::vector<std::string> comments{};    // of the CSV
};

[[nodiscard]] Figure model_residual_figure(const ModelResidualData& data, const std::string& name);

} // namespace dyncal::inline views::figures
