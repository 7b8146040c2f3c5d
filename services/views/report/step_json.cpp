#include "services/views/report/step_json.hpp"

#include <numbers>

#include "analysis/uncertainty/coverage.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::services {

using Json = nlohmann::ordered_json;

Json degrees(double angle_rad) {
  constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
  return json_number(angle_rad * degrees_per_radian);
}

Json value_json(const StepResult& result) {
  return {{"channel", result.channel},
          {"step", result.step},
          {"frequency_text_hz", result.frequency_text_hz},
          {"frequency_hz", json_number(result.frequency_hz)},
          {"level_m_s2", json_number(result.level_m_s2)},
          {"repetition", result.repetition},
          {"valid", result.valid},
          {"magnitude", json_number(result.magnitude)},
          {"u_magnitude", json_number(result.u_magnitude)},
          {"phase_rad", json_number(result.phase_rad)},
          {"phase_deg", degrees(result.phase_rad)},
          {"u_phase_rad", json_number(result.u_phase_rad)},
          {"unit", result.unit},
          {"lost", result.lost}};
}

Json mean_json(const FrequencyPoint& point) {
  const ExpandedUncertainty magnitude = magnitude_uncertainty(point.mean);
  const ExpandedUncertainty phase = phase_uncertainty(point.mean);
  Json json{{"frequency_text_hz", point.frequency_text_hz},
            {"frequency_hz", json_number(point.frequency_hz)},
            {"level_m_s2", json_number(point.level_m_s2)},
            {"magnitude", json_number(point.mean.magnitude)},
            {"u_magnitude", json_number(magnitude.u)},
            {"phase_rad", json_number(point.mean.phase_rad)},
            {"phase_deg", degrees(point.mean.phase_rad)},
            {"u_phase_rad", json_number(phase.u)},
            {"unwrapped_phase_rad", json_number(point.unwrapped_phase_rad)},
            {"unwrapped_phase_deg", degrees(point.unwrapped_phase_rad)},
            {"scatter_magnitude", json_number(point.mean.scatter_magnitude)},
            {"scatter_phase_rad", json_number(point.mean.scatter_phase_rad)},
            {"repetitions", point.mean.repetitions}};
  add_expanded(magnitude, phase, json);
  return json;
}

Json budget_json(const StepResult& result) {
  Json rows = Json::array();
  for (const analysis::Contribution& row : result.budget) {
    rows.push_back({{"name", row.name()},
                    {"kind", to_string(row.kind)},
                    {"subject", row.subject},
                    {"distribution", to_string(row.distribution)},
                    {"repeats", to_string(row.repeats)},
                    {"degrees_of_freedom", json_number(row.degrees_of_freedom)}, // null: infinite
                    {"u_magnitude_rel", json_number(row.u_magnitude_rel)},
                    {"u_lasting_magnitude_rel", json_number(row.u_lasting_magnitude_rel)},
                    {"u_phase_rad", json_number(row.u_phase_rad)}});
  }
  return rows;
}

Json signals_json(const StepResult& result) {
  Json signals = Json::array();
  for (const ChannelSignal& signal : result.signals) {
    signals.push_back({{"channel", signal.channel},
                       {"thd", json_number(signal.thd)},
                       {"u_thd", json_number(signal.u_thd)},
                       {"residual_rel", json_number(signal.residual)},
                       {"residual_over_noise", json_number(signal.over_noise)}});
  }
  return signals;
}

void add_expanded(const ExpandedUncertainty& magnitude, const ExpandedUncertainty& phase,
                  Json& json) {
  json["u_phase_deg"] = degrees(phase.u);
  json["k_magnitude"] = json_number(magnitude.k);
  json["nu_eff_magnitude"] = json_number(magnitude.nu_eff); // null: infinite
  json["U_magnitude"] = json_number(magnitude.expanded);
  json["k_phase"] = json_number(phase.k);
  json["nu_eff_phase"] = json_number(phase.nu_eff);
  json["U_phase_rad"] = json_number(phase.expanded);
  json["U_phase_deg"] = degrees(phase.expanded);
  json["coverage_probability"] = analysis::two_sigma_probability;
}

} // namespace dyncal::services
