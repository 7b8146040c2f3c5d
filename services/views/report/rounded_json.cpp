#include "services/views/report/rounded_json.hpp"

#include <cmath>

#include <fmt/core.h>

#include "services/base/rounding.hpp"

namespace dyncal::inline views {
namespace {

using Json = nlohmann::ordered_json;

Json texts(const RoundedValue& rounded, double value, double u) {
  return {{"value", std::isfinite(value) ? Json(rounded.value) : Json(nullptr)},
          {"u", std::isfinite(u) ? Json(rounded.u) : Json(nullptr)}};
}

} // namespace

nlohmann::ordered_json rounded_json(double value, double u) {
  return texts(round_by_uncertainty(value, u), value, u);
}

nlohmann::ordered_json rounded_json(double value, const analysis::CombinedUncertainty& of_value) {
  const RoundedValue rounded = round_by_uncertainty(value, of_value.expanded());
  Json json = texts(rounded, value, of_value.u);
  json["u"] = std::isfinite(of_value.u) ? Json(rounded_uncertainty(of_value.u)) : Json(nullptr);
  json["U"] = std::isfinite(of_value.u) ? Json(rounded.u) : Json(nullptr);
  json["k"] = fmt::format("{:.2f}", of_value.k);
  return json;
}

nlohmann::ordered_json rounded_json(double magnitude, double u_magnitude, double phase_rad,
                                    double u_phase_rad) {
  const RoundedPhase phase = round_phase(phase_rad, u_phase_rad);
  return {{"magnitude", rounded_json(magnitude, u_magnitude)},
          {"phase_rad", texts(phase.radians, phase_rad, u_phase_rad)},
          {"phase_deg", texts(phase.degrees, phase_rad, u_phase_rad)}};
}

} // namespace dyncal::inline views
