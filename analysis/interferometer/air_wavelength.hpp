// The wavelength of a laser in air from that in vacuum, and its standard uncertainty.
//
//   lambda = lambda_vacuum / n
//   (n - 1)_tp by Boensch and Potulski, Metrologia 35 (1998) 133: dispersion at 20 degrees and
//   100 kPa, carbon dioxide, density by pressure and temperature, humidity by its partial pressure
//
// For 350 nm to 650 nm, extrapolated to 1600 nm within 3e-8 of Ciddor's equation. The formula is
// taken for good to 3e-8; sensors of air matter more: 1 K is -0.95e-6, 1 kPa is 2.7e-6, 10 % of
// relative humidity -0.1e-6. A free-running 633 nm He-Ne laser has 632.9908 nm in vacuum with a
// relative standard uncertainty of 1.5e-6. Any thread.
#pragma once

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

inline constexpr double helium_neon_vacuum_wavelength_m = 632.9908e-9;
inline constexpr double helium_neon_u_rel = 1.5e-6;

struct Air {
  double temperature_c = 20.0;
  double pressure_pa = 101325.0;
  double relative_humidity = 0.5; // of 1
  double carbon_dioxide_fraction = 450e-6;
};

struct AirUncertainty {
  double u_temperature_k = 1.0;
  double u_pressure_pa = 3000.0; // weather, where nothing measures it
  double u_relative_humidity = 0.2;
};

struct AirWavelength {
  double wavelength_m = 0.0;
  double u_rel = 0.0; // laser, air and formula
};

// n - 1.
[[nodiscard]] double refractivity(double vacuum_wavelength_m, const Air& air);

// Fails (invalid_argument): a wavelength outside 350 nm to 1600 nm, air outside 0 to 50 degrees, 60
// to 120 kPa, humidity outside 0 to 1.
[[nodiscard]] Expected<AirWavelength> wavelength_in_air(double vacuum_wavelength_m, double u_rel,
                                                        const Air& air,
                                                        const AirUncertainty& uncertainty);

} // namespace dyncal::analysis
