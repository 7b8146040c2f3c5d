#include "services/evaluation/result/transfer_function_message.hpp"

#include <complex>

#include "services/base/version.hpp"
#include "services/contract/evaluation_method_message.hpp"

namespace dyncal::inline evaluation {
namespace {

wire::TransferPoint point_message(const FrequencyPoint& point) {
  wire::TransferPoint message;
  message.frequency_text_hz(point.frequency_text_hz);
  message.frequency_hz(point.frequency_hz);
  message.level_m_s2(point.level_m_s2);
  message.magnitude(point.mean.magnitude);
  message.u_magnitude(point.mean.u_magnitude);
  message.phase_rad(point.mean.phase_rad);
  message.u_phase_rad(point.mean.u_phase_rad);
  message.unwrapped_phase_rad(point.unwrapped_phase_rad);
  message.scatter_magnitude(point.mean.scatter_magnitude);
  message.scatter_phase_rad(point.mean.scatter_phase_rad);
  message.repetitions(static_cast<std::uint32_t>(point.mean.repetitions));
  return message;
}

FrequencyPoint point_from_message(const wire::TransferPoint& message) {
  FrequencyPoint point;
  point.frequency_text_hz = message.frequency_text_hz();
  point.frequency_hz = message.frequency_hz();
  point.level_m_s2 = message.level_m_s2();
  point.mean.h = std::polar(message.magnitude(), message.phase_rad());
  point.mean.magnitude = message.magnitude();
  point.mean.u_magnitude = message.u_magnitude();
  point.mean.phase_rad = message.phase_rad();
  point.mean.u_phase_rad = message.u_phase_rad();
  point.mean.scatter_magnitude = message.scatter_magnitude();
  point.mean.scatter_phase_rad = message.scatter_phase_rad();
  point.mean.repetitions = message.repetitions();
  point.unwrapped_phase_rad = message.unwrapped_phase_rad();
  return point;
}

wire::MeanUncertainty uncertainty_message(const analysis::RepetitionMean& mean) {
  wire::MeanUncertainty message;
  message.u_magnitude_rel(mean.magnitude_rel.u);
  message.degrees_of_freedom_magnitude(mean.magnitude_rel.degrees_of_freedom);
  message.k_magnitude(mean.magnitude_rel.k);
  message.u_phase_rad(mean.phase.u);
  message.degrees_of_freedom_phase(mean.phase.degrees_of_freedom);
  message.k_phase(mean.phase.k);
  message.u_independent_phase_rad(mean.u_independent_phase_rad);
  return message;
}

void read_uncertainty(const wire::MeanUncertainty& message, analysis::RepetitionMean& mean) {
  mean.magnitude_rel = {message.u_magnitude_rel(), message.degrees_of_freedom_magnitude(),
                        message.k_magnitude()};
  mean.phase = {message.u_phase_rad(), message.degrees_of_freedom_phase(), message.k_phase()};
  mean.u_independent_phase_rad = message.u_independent_phase_rad();
}

} // namespace

wire::TransferFunction to_message(const Recipe& recipe, const TransferFunction& function) {
  wire::TransferFunction message;
  message.bench(recipe.bench);
  message.run(recipe.run);
  message.channel(function.channel);
  message.method(to_wire(function.method));
  message.unit(function.unit);
  for (const FrequencyPoint& point : function.points) {
    message.points().push_back(point_message(point));
    message.mean_uncertainties().push_back(uncertainty_message(point.mean));
  }
  message.group_delay_valid(function.group_delay.has_value());
  message.group_delay_problem(function.group_delay_problem);
  if (function.group_delay) {
    const analysis::GroupDelay& delay = *function.group_delay;
    message.group_delay_s(delay.delay_s);
    message.u_group_delay_s(delay.u_delay_s);
    message.intercept_rad(delay.intercept_rad);
    message.u_intercept_rad(delay.u_intercept_rad);
    message.cov_delay_intercept_rad_s(delay.cov_delay_intercept);
    message.phase_covariance_rad2() = delay.phase_covariance;
    message.polarity_inverted(delay.polarity_inverted);
    message.group_delay_chi_squared(delay.chi_squared);
    message.group_delay_degrees_of_freedom(delay.degrees_of_freedom);
  }
  message.flags() = sentences_of(function.flags);
  message.flag_names() = names_of(function.flags);
  message.lost(function.lost);
  message.software(software_version());
  message.recipe_sha256(recipe.sha256);
  return message;
}

TransferFunction from_message(const wire::TransferFunction& message) {
  TransferFunction function;
  function.channel = message.channel().to_string();
  function.method = from_wire(message.method()).value_or(EvaluationMethod::sample_timestamping);
  function.unit = message.unit();
  for (std::size_t i = 0; i < message.points().size(); ++i) {
    function.points.push_back(point_from_message(message.points()[i]));
    if (i < message.mean_uncertainties().size()) {
      read_uncertainty(message.mean_uncertainties()[i], function.points.back().mean);
    }
  }
  if (message.group_delay_valid()) {
    analysis::GroupDelay& delay = function.group_delay.emplace();
    delay.delay_s = message.group_delay_s();
    delay.u_delay_s = message.u_group_delay_s();
    delay.intercept_rad = message.intercept_rad();
    delay.u_intercept_rad = message.u_intercept_rad();
    delay.cov_delay_intercept = message.cov_delay_intercept_rad_s();
    delay.phase_covariance = message.phase_covariance_rad2();
    delay.polarity_inverted = message.polarity_inverted();
    delay.chi_squared = message.group_delay_chi_squared();
    delay.degrees_of_freedom = message.group_delay_degrees_of_freedom();
  }
  function.group_delay_problem = message.group_delay_problem();
  function.flags = flags_from_message(message.flags(), message.flag_names());
  function.lost = message.lost();
  return function;
}

} // namespace dyncal::inline evaluation
