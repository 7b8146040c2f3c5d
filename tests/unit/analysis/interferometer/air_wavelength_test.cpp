// Against Ciddor's equation, which is another one: his table 1 for dry air of 450 ppm at 633 nm,
// and the values of NIST's calculator.
#include "analysis/interferometer/air_wavelength.hpp"

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(AirWavelength, RefractivityAgreesWithCiddor) {
  struct Case {
    double temperature_c;
    double pressure_pa;
    double refractivity;
  };
  for (const Case& one : {Case{20.0, 80e3, 21458.0e-8},
                          {20.0, 100e3, 26824.4e-8},
                          {20.0, 120e3, 32191.6e-8},
                          {10.0, 100e3, 27774.7e-8},
                          {30.0, 100e3, 25937.2e-8}}) {
    const Air air{one.temperature_c, one.pressure_pa, 0.0, 450e-6};
    EXPECT_NEAR(refractivity(633e-9, air), one.refractivity, 3e-8)
        << one.temperature_c << " " << one.pressure_pa;
  }
  EXPECT_NEAR(refractivity(633e-9, {20.0, 101325.0, 0.5, 450e-6}), 1.000271373 - 1.0, 3e-8);
  EXPECT_NEAR(refractivity(500e-9, {20.0, 101325.0, 0.5, 450e-6}), 1.000273781 - 1.0, 3e-8);
  EXPECT_NEAR(refractivity(1500.8e-9, {20.0, 101325.0, 0.5, 450e-6}), 1.00026819 - 1.0, 3e-8);
}

TEST(AirWavelength, OfAHeliumNeonLaser) {
  const auto known = wavelength_in_air(helium_neon_vacuum_wavelength_m, helium_neon_u_rel,
                                       {23.0, 101325.0, 0.5, 450e-6}, {0.1, 50.0, 0.05});
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->wavelength_m, 632.8209e-9, 0.5e-13);
  EXPECT_NEAR(known->u_rel, 1.5e-6, 0.1e-6); // the laser
  const auto unknown =
      wavelength_in_air(helium_neon_vacuum_wavelength_m, helium_neon_u_rel, {}, {});
  ASSERT_TRUE(unknown);
  EXPECT_NEAR(unknown->u_rel, 8.2e-6, 0.3e-6); // the weather
}

TEST(AirWavelength, RefusesPressureInHectopascal) {
  EXPECT_FALSE(wavelength_in_air(helium_neon_vacuum_wavelength_m, 0.0, {20.0, 1013.25, 0.5}, {}));
  EXPECT_FALSE(wavelength_in_air(632.8, 0.0, {}, {}));
  EXPECT_FALSE(wavelength_in_air(helium_neon_vacuum_wavelength_m, 0.0, {20.0, 101325.0, 50.0}, {}));
}

} // namespace
} // namespace dyncal::analysis
