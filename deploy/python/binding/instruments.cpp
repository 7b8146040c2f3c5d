// What is known of ADC, reference and trigger beforehand: analysis/instrument/.
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/complex.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "bindings.hpp"
#include "failure.hpp"
#include "words.hpp"

namespace dyncal::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;
using analysis::AdcCalibrationPoint;
using analysis::AdcResponse;
using analysis::ReferenceCalibrationPoint;
using analysis::ReferenceContribution;
using analysis::ReferenceResponse;

constexpr double infinite = analysis::infinite_degrees_of_freedom;

void bind_adc(nb::module_& module) {
  nb::class_<AdcResponse>(module, "AdcResponse",
                          "Of the DAU's sync ADC at one frequency; a lag is positive.\n"
                          "Source: analysis/instrument/adc_calibration.hpp")
      .def(
          "__init__",
          [](AdcResponse* self, double gain, double phase_lag_rad, double u_gain,
             double u_phase_lag_rad) {
            new (self) AdcResponse{gain, phase_lag_rad, u_gain, u_phase_lag_rad};
          },
          "gain"_a = 1.0, "phase_lag_rad"_a = 0.0, "u_gain"_a = 0.0, "u_phase_lag_rad"_a = 0.0)
      .def_ro("gain", &AdcResponse::gain)
      .def_ro("phase_lag_rad", &AdcResponse::phase_lag_rad)
      .def_ro("u_gain", &AdcResponse::u_gain)
      .def_ro("u_phase_lag_rad", &AdcResponse::u_phase_lag_rad);
  nb::class_<AdcCalibrationPoint>(
      module, "AdcCalibrationPoint",
      "A calibrated point of a DAU's sync ADC: gain, lag in rad (positive).\n"
      "Source: analysis/instrument/adc_calibration.hpp")
      .def(
          "__init__",
          [](AdcCalibrationPoint* self, double frequency_hz, double test_amplitude_vpp, double gain,
             double phase_lag_rad, double u_gain, double u_phase_lag_rad) {
            new (self) AdcCalibrationPoint{frequency_hz, test_amplitude_vpp, gain, phase_lag_rad,
                                           u_gain,       u_phase_lag_rad};
          },
          nb::kw_only(), "frequency_hz"_a, "test_amplitude_vpp"_a, "gain"_a, "phase_lag_rad"_a,
          "u_gain"_a = 0.0, "u_phase_lag_rad"_a = 0.0)
      .def_ro("frequency_hz", &AdcCalibrationPoint::frequency_hz)
      .def_ro("gain", &AdcCalibrationPoint::gain)
      .def_ro("phase_lag_rad", &AdcCalibrationPoint::phase_lag_rad);
  module.def(
      "adc_response_at",
      [](const std::vector<AdcCalibrationPoint>& points, double frequency_hz,
         std::optional<double> test_amplitude_vpp) {
        return value_of(analysis::adc_response_at(points, frequency_hz, test_amplitude_vpp));
      },
      "points"_a, "frequency_hz"_a, "test_amplitude_vpp"_a = nb::none(),
      "The response between calibrated points: delay and low pass exact, the rest interpolated.\n"
      "\n"
      "Raises Error (invalid_argument, out_of_calibration): nothing is extrapolated.\n"
      "Source: analysis/instrument/adc_calibration.hpp");
}

void bind_reference(nb::module_& module) {
  nb::class_<ReferenceContribution>(module, "ReferenceContribution",
                                    "An uncertainty of the reference, by name.\n"
                                    "Source: analysis/instrument/reference_calibration.hpp")
      .def(
          "__init__",
          [](ReferenceContribution* self, const std::string& name, double u_magnitude_rel,
             double u_phase_rad, const std::string& distribution, double degrees_of_freedom) {
            new (self) ReferenceContribution{name, distribution_of(distribution), u_magnitude_rel,
                                             u_phase_rad, degrees_of_freedom};
          },
          "name"_a = "", nb::kw_only(), "u_magnitude_rel"_a = 0.0, "u_phase_rad"_a = 0.0,
          "distribution"_a = "normal", "degrees_of_freedom"_a = infinite)
      .def_ro("name", &ReferenceContribution::name)
      .def_ro("u_magnitude_rel", &ReferenceContribution::u_magnitude_rel)
      .def_ro("u_phase_rad", &ReferenceContribution::u_phase_rad);
  nb::class_<ReferenceCalibrationPoint>(module, "ReferenceCalibrationPoint",
                                        "A point of the reference's certificate.\n"
                                        "Source: analysis/instrument/reference_calibration.hpp")
      .def(
          "__init__",
          [](ReferenceCalibrationPoint* self, double frequency_hz, double level_m_s2,
             double magnitude, double phase_rad,
             const std::vector<ReferenceContribution>& contributions) {
            new (self) ReferenceCalibrationPoint{frequency_hz, level_m_s2, magnitude, phase_rad,
                                                 contributions};
          },
          nb::kw_only(), "frequency_hz"_a, "level_m_s2"_a, "magnitude"_a = 1.0, "phase_rad"_a = 0.0,
          "contributions"_a = std::vector<ReferenceContribution>{})
      .def_ro("frequency_hz", &ReferenceCalibrationPoint::frequency_hz)
      .def_ro("level_m_s2", &ReferenceCalibrationPoint::level_m_s2)
      .def_ro("magnitude", &ReferenceCalibrationPoint::magnitude)
      .def_ro("phase_rad", &ReferenceCalibrationPoint::phase_rad);
  nb::class_<ReferenceResponse>(module, "ReferenceResponse",
                                "What the reference's channel reads over what is; phase is lead.\n"
                                "Source: analysis/instrument/reference_calibration.hpp")
      .def(
          "__init__",
          [](ReferenceResponse* self, double magnitude, double phase_rad,
             const std::vector<ReferenceContribution>& contributions) {
            new (self) ReferenceResponse{magnitude, phase_rad, contributions};
          },
          "magnitude"_a = 1.0, "phase_rad"_a = 0.0,
          "contributions"_a = std::vector<ReferenceContribution>{})
      .def_ro("magnitude", &ReferenceResponse::magnitude)
      .def_ro("phase_rad", &ReferenceResponse::phase_rad, "lead, (-pi, pi]")
      .def_ro("contributions", &ReferenceResponse::contributions)
      .def_prop_ro("phasor", &ReferenceResponse::phasor);
  module.def(
      "reference_response_at",
      [](const std::vector<ReferenceCalibrationPoint>& points, double frequency_hz,
         double level_m_s2) {
        return value_of(analysis::reference_response_at(points, frequency_hz, level_m_s2));
      },
      "points"_a, "frequency_hz"_a, "level_m_s2"_a,
      "The response between the points of the certificate.\n"
      "\n"
      "Raises Error (invalid_argument, out_of_calibration): nothing is extrapolated.\n"
      "Source: ISO 16063-11 annex A; analysis/instrument/reference_calibration.hpp");
}

} // namespace

void bind_instruments(nb::module_& module) {
  bind_adc(module);
  bind_reference(module);
}

} // namespace dyncal::python
