#include "services/report/step_json.hpp"

#include <numbers>

#include "analysis/uncertainty/coverage.hpp"
#include "services/report/json_number.hpp"

namespace dyncal::services {

using Json = nlohmann::ordered_json;

Json degrees(double angle_rad) {
  constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
  return json_number(angle_rad * degrees_per_radian);
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
