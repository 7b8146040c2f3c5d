// Quadrature signals of a laser to acceleration: analysis/interferometer/.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include "analysis/interferometer/air_wavelength.hpp"
#include "analysis/interferometer/decimation_filter.hpp"
#include "analysis/interferometer/quadrature_phase.hpp"
#include "analysis/interferometer/record_ellipse.hpp"
#include "analysis/interferometer/reference_motion.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "frequency_argument.hpp"

namespace dyncal::python {
namespace {

using namespace nb::literals;
using analysis::DecimationFilter;
using analysis::Ellipse;
using analysis::EllipseFit;
using analysis::MotionQuantity;
using analysis::PhaseStatistics;
using analysis::QuadraturePhase;
using analysis::StepMotion;

// Calls work(u1, u2) with spans of the numbers that both arrays have: int16, float32 or float64.
template <class Work>
auto with_signals(const nb::object& u1, const nb::object& u2, Work&& work) {
  const auto pair = [&]<class T>(T /*number*/) {
    Array<T> first(u1);
    Array<T> second(u2);
    const auto x = first.span("u1");
    const auto y = second.span("u2");
    if (x.size() != y.size()) {
      refuse("u1 and u2 must have one length");
    }
    return work(x, y);
  };
  const nb::object element = nb::getattr(u1, "dtype", nb::none());
  const std::string type = nb::cast<std::string>(nb::str(element));
  return type == "int16"     ? pair(std::int16_t{})
         : type == "float32" ? pair(float{})
                             : pair(double{});
}

EllipseFit ellipse_of_record(const nb::object& u1, const nb::object& u2) {
  return with_signals(u1, u2, [](auto x, auto y) {
    const nb::gil_scoped_release released;
    return value_of(analysis::ellipse_of_record(x, y)).fit;
  });
}

NewArray<double> push(QuadraturePhase& phase, const nb::object& u1, const nb::object& u2) {
  return with_signals(u1, u2, [&](auto x, auto y) {
    std::vector<double> turns(x.size());
    {
      const nb::gil_scoped_release released;
      value_of(phase.push(x, y, turns));
    }
    return to_numpy(std::move(turns));
  });
}

void bind_ellipse(nb::module_& module) {
  nb::class_<Ellipse>(module, "Ellipse",
                      "u1 = p + R cos(phi), u2 = q + (R / r) sin(phi - alpha).\n"
                      "Source: Heydemann, Appl. Opt. 20 (1981) 3382;\n"
                      "analysis/interferometer/ellipse_fit.hpp")
      .def(
          "__init__",
          [](Ellipse* self, double p, double q, double r, double alpha_rad, double radius) {
            new (self) Ellipse{p, q, r, alpha_rad, radius};
          },
          "p"_a = 0.0, "q"_a = 0.0, "r"_a = 1.0, "alpha_rad"_a = 0.0, "radius"_a = 1.0)
      .def_ro("p", &Ellipse::p, "centre of u1")
      .def_ro("q", &Ellipse::q, "centre of u2")
      .def_ro("r", &Ellipse::r, "amplitude of u1 over that of u2")
      .def_ro("alpha_rad", &Ellipse::alpha_rad, "by how much u2 lags behind quadrature")
      .def_ro("radius", &Ellipse::radius, "R, amplitude of u1");
  nb::class_<EllipseFit>(module, "EllipseFit",
                         "An ellipse and how well it is known; sizes in the unit of the signals.\n"
                         "Source: analysis/interferometer/ellipse_fit.hpp")
      .def_ro("ellipse", &EllipseFit::ellipse)
      .def_prop_ro(
          "method",
          [](const EllipseFit& fit) { return std::string(analysis::to_string(fit.method)); })
      .def_ro("covariance", &EllipseFit::covariance, "of p, q, r, alpha, R: 5 rows of 5")
      .def_ro("noise_sd_1", &EllipseFit::noise_sd_1, "of u1, in its unit")
      .def_ro("noise_sd_2", &EllipseFit::noise_sd_2)
      .def_ro("radius_residual_sd", &EllipseFit::radius_residual_sd)
      .def_ro("turns_covered", &EllipseFit::turns_covered);
  module.def("ellipse_of_record", &ellipse_of_record, "u1"_a, "u2"_a,
             nb::sig("def ellipse_of_record(u1: numpy.typing.NDArray[typing.Any], u2: "
                     "numpy.typing.NDArray[typing.Any]) -> EllipseFit"),
             "The ellipse of a record of both detectors: (n,) int16, float32 or float64, alike.\n"
             "\n"
             "Raises Error (ill_conditioned: an arc too short, no ellipse; too_few_samples,\n"
             "not_finite); the sentence says what to do.\n"
             "Source: Heydemann 1981; analysis/interferometer/ellipse_fit.hpp");
}

void bind_phase(nb::module_& module) {
  nb::class_<PhaseStatistics>(module, "PhaseStatistics",
                              "Of all that was pushed; in turns of phase.\n"
                              "Source: analysis/interferometer/quadrature_phase.hpp")
      .def_ro("samples", &PhaseStatistics::samples)
      .def_ro("doubtful", &PhaseStatistics::doubtful,
              "samples more than a quarter of a turn from the one expected")
      .def_ro("max_prediction_error", &PhaseStatistics::max_prediction_error, "turns")
      .def_prop_ro("turns_covered", &PhaseStatistics::turns_covered)
      .def_prop_ro("radius_ratio", &PhaseStatistics::radius_ratio,
                   "smallest over largest radius; below 0.9 a detector is too slow");
  nb::class_<QuadraturePhase>(module, "QuadraturePhase",
                              "Unwrapped phase of quadrature signals, in blocks of any size.\n"
                              "Source: analysis/interferometer/quadrature_phase.hpp")
      .def(nb::init<const Ellipse&>(), "ellipse"_a)
      .def("push", &push, "u1"_a, "u2"_a,
           nb::sig("def push(self, u1: numpy.typing.NDArray[typing.Any], u2: "
                   "numpy.typing.NDArray[typing.Any]) -> numpy.typing.NDArray[numpy.float64]"),
           "Turns of phase, float64 (n,), of (n,) int16, float32 or float64 each.\n"
           "\n"
           "Raises Error (not_finite, invalid_argument).")
      .def_prop_ro("statistics", [](const QuadraturePhase& phase) { return phase.statistics(); });
  module.def("displacement_per_turn_m", &analysis::displacement_per_turn_m, "wavelength_m"_a,
             "passes"_a = 1,
             "lambda / (2 N), m: lambda in air, N passes (1: Michelson).\n"
             "Source: ISO 16063-11; analysis/interferometer/quadrature_phase.hpp");
  module.def(
      "wavelength_in_air",
      [](double vacuum_wavelength_m, double u_rel, double temperature_c, double pressure_pa,
         double relative_humidity) {
        const analysis::Air air{.temperature_c = temperature_c,
                                .pressure_pa = pressure_pa,
                                .relative_humidity = relative_humidity};
        const auto found =
            value_of(analysis::wavelength_in_air(vacuum_wavelength_m, u_rel, air, {}));
        return std::pair(found.wavelength_m, found.u_rel);
      },
      "vacuum_wavelength_m"_a = analysis::helium_neon_vacuum_wavelength_m,
      "u_rel"_a = analysis::helium_neon_u_rel, nb::kw_only(), "temperature_c"_a = 20.0,
      "pressure_pa"_a = 101325.0, "relative_humidity"_a = 0.5,
      "Wavelength in m and its relative standard uncertainty, where nothing measures the air.\n"
      "\n"
      "Raises Error (invalid_argument). Source: Boensch and Potulski, Metrologia 35 (1998) 133;\n"
      "analysis/interferometer/air_wavelength.hpp");
}

void bind_decimation(nb::module_& module) {
  nb::class_<DecimationFilter>(module, "DecimationFilter",
                               "A low-pass filter that keeps every D-th value, in blocks.\n"
                               "Source: analysis/interferometer/decimation_filter.hpp")
      .def(
          "__init__",
          [](DecimationFilter* self, std::size_t factor) {
            if (factor < 1) {
              refuse("factor must be at least 1");
            }
            new (self) DecimationFilter(factor);
          },
          "factor"_a)
      .def(
          "push",
          [](DecimationFilter& filter, Array<double> values) {
            std::vector<double> decimated;
            filter.push(values.span("values"), decimated);
            return to_numpy(std::move(decimated));
          },
          "values"_a, "Decimated values, float64, of float64 (n,).")
      .def_prop_ro("factor", &DecimationFilter::factor)
      .def_prop_ro("first_sample", &DecimationFilter::first_sample,
                   "input sample of the first output; as many are lost at the end")
      .def("gain", &DecimationFilter::gain, "cycles_per_sample"_a,
           "at a frequency in cycles per sample of the input");
}

MotionQuantity quantity_named(const std::string& word) {
  for (const MotionQuantity quantity : {MotionQuantity::velocity, MotionQuantity::displacement}) {
    if (word == to_string(quantity)) {
      return quantity;
    }
  }
  refuse("quantity is '" + word + "', but must be 'velocity' or 'displacement'");
}

StepMotion motion_of_step(const FrequencyArgument& frequency, Array<std::int64_t> stamps_ns,
                          Array<double> values, const std::string& quantity) {
  const MotionQuantity named = quantity_named(quantity);
  const analysis::Frequency of_step = frequency.frequency();
  const auto stamps = stamps_ns.span("stamps_ns");
  const auto samples = values.span("values");
  const nb::gil_scoped_release released;
  return value_of(analysis::motion_of_step(named, of_step, stamps, samples));
}

void bind_motion(nb::module_& module) {
  nb::class_<StepMotion>(
      module, "StepMotion",
      "The motion of a step at a lower rate, for a sine fit, in the unit of the samples.\n"
      "Source: analysis/interferometer/reference_motion.hpp")
      .def_prop_ro(
          "stamps_ns", [](const StepMotion& motion) { return to_numpy(motion.stamps_ns); },
          nb::rv_policy::move, "int64 (n,)")
      .def_prop_ro(
          "values", [](const StepMotion& motion) { return to_numpy(motion.values); },
          nb::rv_policy::move, "float64 (n,)")
      .def_ro("noise_factor", &StepMotion::noise_factor, "for u of a sine fit")
      .def_ro("rate_hz", &StepMotion::rate_hz);
  module.def(
      "motion_of_step", &motion_of_step, "frequency"_a, "stamps_ns"_a, "values"_a,
      "quantity"_a = "displacement",
      "Displacement or velocity of a step without the slow motion of the table, right at the\n"
      "frequency of the step only; its acceleration is -w^2 times the displacement, i w\n"
      "times the velocity.\n"
      "\n"
      "stamps_ns: int64 (n,), values: float64 (n,) in any unit; quantity: 'displacement' or\n"
      "'velocity'. Raises Error (frequency_out_of_range: fewer than 4 samples a period;\n"
      "too_few_samples, invalid_argument). The GIL is released.\n"
      "Source: analysis/interferometer/reference_motion.hpp");
}

} // namespace

void bind_interferometer(nb::module_& module) {
  bind_ellipse(module);
  bind_phase(module);
  bind_decimation(module);
  bind_motion(module);
}

} // namespace dyncal::python
