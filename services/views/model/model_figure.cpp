#include "services/views/model/model_figure.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/base/rounding.hpp"
#include "services/views/figures/model_residuals.hpp"

namespace dyncal::inline views {

figures::Figure model_figure(const ChannelModel& model) {
  const analysis::FittedResponse& fit = model.fit();
  figures::ModelResidualData data;
  data.title = fmt::format("{}: {}", model.measured.channel, to_string(fit.kind));
  data.subtitle = fmt::format(
      "chi-squared {:.4g} for {} degrees of freedom, {}{}", fit.chi_squared, fit.degrees_of_freedom,
      probability_text(model.choice.best().probability), model.choice.fits ? "" : ": does not fit");
  for (std::size_t k = 0; k < fit.names.size(); ++k) {
    const RoundedValue rounded = round_by_uncertainty(fit.values[k], fit.of_values[k].expanded());
    data.comments.push_back(fmt::format("{} = {}, U = {}", fit.names[k], rounded.value, rounded.u));
  }
  data.comments.insert(data.comments.end(), model.warnings.begin(), model.warnings.end());
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    const MeasuredValue& value = model.measured.values[i];
    const analysis::ResponseResidual& residual = fit.residuals[i];
    data.residuals.push_back({.frequency_hz = value.point.frequency_hz,
                              .magnitude_rel = residual.magnitude_rel,
                              .u_magnitude_rel = value.u_magnitude_rel,
                              .u_own_magnitude_rel = value.point.u_magnitude_rel,
                              .own_magnitude_rel = residual.own_magnitude_rel,
                              .phase_rad = residual.phase_rad,
                              .u_phase_rad = value.u_phase_rad,
                              .u_own_phase_rad = value.point.u_phase_rad,
                              .own_phase_rad = residual.own_phase_rad});
  }
  std::stable_sort(data.residuals.begin(), data.residuals.end(),
                   [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
  std::string place = model.measured.channel;
  std::replace(place.begin(), place.end(), '/', '-');
  return figures::model_residual_figure(data, "model-residuals-" + place);
}

} // namespace dyncal::inline views
