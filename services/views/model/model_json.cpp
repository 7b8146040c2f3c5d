#include "services/views/model/model_json.hpp"

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "services/base/version.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::inline views {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

// A square matrix with zeros in front of its first row and column.
Json matrix_json(const std::vector<double>& elements, std::size_t size, std::size_t zeros = 0) {
  Json matrix = Json::array();
  for (std::size_t i = 0; i < zeros + size; ++i) {
    Json row = Json::array();
    for (std::size_t j = 0; j < zeros + size; ++j) {
      row.push_back(i < zeros || j < zeros
                        ? Json(0.0)
                        : json_number(elements[(i - zeros) * size + (j - zeros)]));
    }
    matrix.push_back(std::move(row));
  }
  return matrix;
}

const char* unit_of(const std::string& parameter) {
  if (parameter == "gain") {
    return "unit";
  }
  if (parameter == "delay_s") {
    return "s";
  }
  return parameter == "damping" ? "1" : "Hz";
}

Json parameters_json(const analysis::FittedResponse& fit) {
  Json parameters = Json::array();
  for (std::size_t k = 0; k < fit.names.size(); ++k) {
    parameters.push_back(
        {{"name", fit.names[k]},
         {"in", unit_of(fit.names[k])},
         {"value", json_number(fit.values[k])},
         {"u", json_number(fit.of_values[k].u)},
         {"k", json_number(fit.of_values[k].k)},
         {"U", json_number(fit.of_values[k].expanded())},
         {"degrees_of_freedom", json_number(fit.of_values[k].degrees_of_freedom)}});
  }
  return parameters;
}

Json candidate_json(const analysis::ResponseCandidate& candidate) {
  Json json{{"kind", name_of(candidate.kind)},
            {"parameter_count", parameter_count(candidate.kind)},
            {"problem", candidate.problem}};
  if (candidate.fit) {
    json["chi_squared"] = json_number(candidate.fit->chi_squared);
    json["degrees_of_freedom"] = json_number(candidate.fit->degrees_of_freedom);
    json["probability"] = json_number(candidate.probability);
    json["aic"] = json_number(candidate.aic);
    json["bic"] = json_number(candidate.bic);
    json["undetermined"] = candidate.fit->undetermined;
    json["parameters"] = parameters_json(*candidate.fit);
  }
  return json;
}

Json points_json(const ChannelModel& model) {
  Json points = Json::array();
  for (std::size_t i = 0; i < model.measured.values.size(); ++i) {
    const MeasuredValue& value = model.measured.values[i];
    const analysis::ResponseResidual& residual = model.fit().residuals[i];
    const std::complex<double> h = response_at(model.fit().parameters, value.point.frequency_hz);
    points.push_back({{"file", value.file},
                      {"frequency_text_hz", value.frequency_text_hz},
                      {"frequency_hz", value.point.frequency_hz},
                      {"magnitude", std::abs(value.point.h)},
                      {"phase_rad", std::arg(value.point.h)},
                      {"u_magnitude_rel", value.u_magnitude_rel},
                      {"u_phase_rad", value.u_phase_rad},
                      {"u_own_magnitude_rel", value.point.u_magnitude_rel},
                      {"u_own_phase_rad", value.point.u_phase_rad},
                      {"model_magnitude", std::abs(h)},
                      {"model_phase_rad", std::arg(h)},
                      {"residual_magnitude_rel", residual.magnitude_rel},
                      {"residual_phase_rad", residual.phase_rad},
                      {"residual_phase_deg", residual.phase_rad * degrees_per_radian},
                      {"own_residual_magnitude_rel", residual.own_magnitude_rel},
                      {"own_residual_phase_rad", residual.own_phase_rad},
                      {"flag_names", value.flag_names}});
  }
  return points;
}

Json filter_json(const ChannelModel& model) {
  if (!model.filter) {
    return nullptr;
  }
  const analysis::CompensationFilter& filter = *model.filter;
  Json json{{"type", filter.a.size() == 1 ? "fir" : "iir"},
            {"rate_hz", filter.rate_hz},
            {"b", filter.b},
            {"a", filter.a},
            {"delay_samples", filter.delay_samples},
            {"delay_s", filter.delay_samples / filter.rate_hz},
            {"cutoff_hz", filter.cutoff_hz},
            {"stop_hz", filter.stop_hz},
            {"ripple", json_number(filter.ripple)},
            {"stop_gain", json_number(filter.stop_gain)},
            {"noise_gain", json_number(filter.noise_gain)},
            {"covariance_from", "Jacobian of the coefficients by the parameters of the model"},
            {"Ub", matrix_json(filter.covariance_b, filter.b.size())}};
  if (filter.a.size() > 1) {
    json["Uab"] = matrix_json(filter.covariance_b, filter.b.size(), filter.a.size() - 1);
  }
  json["compensated"] = Json::array();
  for (const analysis::CompensatedPoint& point : model.compensated) {
    json["compensated"].push_back(
        {{"frequency_hz", point.frequency_hz},
         {"magnitude_error", json_number(point.magnitude_error)},
         {"U_magnitude_error", json_number(2.0 * point.u_magnitude)},
         {"phase_error_rad", json_number(point.phase_error_rad)},
         {"U_phase_error_rad", json_number(2.0 * point.u_phase_rad)},
         {"measured_magnitude_error", json_number(point.measured_magnitude_error)},
         {"measured_phase_error_rad", json_number(point.measured_phase_error_rad)}});
  }
  return json;
}

Json channel_json(const ChannelModel& model) {
  const analysis::FittedResponse& fit = model.fit();
  const MeasuredResponse& measured = model.measured;
  Json json{{"channel", measured.channel},
            {"unit", measured.unit},
            {"kind", name_of(fit.kind)},
            {"fits", model.choice.fits},
            {"reason", reason_of(model.choice)},
            {"warnings", model.warnings},
            {"parameters", parameters_json(fit)},
            {"covariance", matrix_json(fit.covariance, fit.names.size())},
            {"chi_squared", json_number(fit.chi_squared)},
            {"degrees_of_freedom", json_number(fit.degrees_of_freedom)},
            {"probability", json_number(model.choice.best().probability)},
            {"common",
             {{"u_gain_rel", measured.common.gain_rel},
              {"u_delay_s", measured.common.delay_s},
              {"u_phase_rad", measured.common.phase_rad},
              {"from_budgets", measured.has_budgets}}},
            {"other_delays", Json::array()},
            {"candidates", Json::array()},
            {"left_out", Json::array()}};
  for (const analysis::OtherDelay& other : fit.other_delays) {
    json["other_delays"].push_back({{"delay_s", other.delay_s},
                                    {"polarity_inverted", other.polarity_inverted},
                                    {"chi_squared", json_number(other.chi_squared)}});
  }
  for (const analysis::ResponseCandidate& candidate : model.choice.candidates) {
    json["candidates"].push_back(candidate_json(candidate));
  }
  for (const ValueLeftOut& value : measured.left_out) {
    json["left_out"].push_back({{"file", value.file},
                                {"frequency_text_hz", value.frequency_text_hz},
                                {"reason", value.reason}});
  }
  json["points"] = points_json(model);
  json["filter"] = filter_json(model);
  return json;
}

} // namespace

nlohmann::ordered_json model_json(const std::vector<std::string>& files,
                                  const std::vector<ChannelModel>& models) {
  Json json{{"schema", {{"name", "dyncal-model"}, {"version", model_schema_version}}},
            {"software", software_version()},
            {"phase_convention",
             "lead: arg H in rad, a delay is negative; u of parameters are standard uncertainties, "
             "U = k u expanded ones (95.45 %); other u are U / 2"},
            {"results", files},
            {"models", Json::array()}};
  for (const ChannelModel& model : models) {
    json["models"].push_back(channel_json(model));
  }
  return json;
}

} // namespace dyncal::inline views
