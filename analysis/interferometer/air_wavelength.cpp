#include "analysis/interferometer/air_wavelength.hpp"

#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double u_of_formula = 3e-8;

// Over water, by Magnus (within 0.3 % of it from 0 to 50 degrees).
double saturation_pressure_pa(double temperature_c) {
  return 611.2 * std::exp(17.62 * temperature_c / (243.12 + temperature_c));
}

bool within_limits(double vacuum_wavelength_m, const Air& air) {
  const auto between = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  return between(vacuum_wavelength_m, 350e-9, 1600e-9) && between(air.temperature_c, 0.0, 50.0) &&
         between(air.pressure_pa, 60e3, 120e3) && between(air.relative_humidity, 0.0, 1.0) &&
         between(air.carbon_dioxide_fraction, 0.0, 2e-3);
}

} // namespace

double refractivity(double vacuum_wavelength_m, const Air& air) {
  const double per_um = 1e-6 / vacuum_wavelength_m;
  const double square = per_um * per_um;
  const double t = air.temperature_c;
  const double p = air.pressure_pa;
  const double dispersion =
      1e-8 * (8091.37 + 2333983.0 / (130.0 - square) + 15518.0 / (38.9 - square));
  const double with_carbon_dioxide =
      dispersion * (1.0 + 0.5327 * (air.carbon_dioxide_fraction - 400e-6));
  const double density =
      p / 93214.60 * (1.0 + 1e-8 * (0.5953 - 0.009876 * t) * p) / (1.0 + 0.0036610 * t);
  const double vapour_pa = air.relative_humidity * saturation_pressure_pa(t);
  return with_carbon_dioxide * density - vapour_pa * (3.8020 - 0.0384 * square) * 1e-10;
}

Expected<AirWavelength> wavelength_in_air(double vacuum_wavelength_m, double u_rel, const Air& air,
                                          const AirUncertainty& uncertainty) {
  if (!within_limits(vacuum_wavelength_m, air)) {
    return fail(ErrorCode::invalid_argument,
                "the wavelength in air is known from 350 nm to 1600 nm, 0 to 50 degrees Celsius, "
                "60 to 120 kPa (in Pa) and a relative humidity from 0 to 1");
  }
  const double here = refractivity(vacuum_wavelength_m, air);
  const auto change = [&](double Air::*quantity, double by) {
    Air other = air;
    other.*quantity += by;
    return refractivity(vacuum_wavelength_m, other) - here;
  };
  AirWavelength result;
  result.wavelength_m = vacuum_wavelength_m / (1.0 + here);
  const double squares =
      u_rel * u_rel + u_of_formula * u_of_formula +
      std::pow(change(&Air::temperature_c, uncertainty.u_temperature_k), 2) +
      std::pow(change(&Air::pressure_pa, uncertainty.u_pressure_pa), 2) +
      std::pow(change(&Air::relative_humidity, uncertainty.u_relative_humidity), 2);
  result.u_rel = std::sqrt(squares);
  return result;
}

} // namespace dyncal::analysis
