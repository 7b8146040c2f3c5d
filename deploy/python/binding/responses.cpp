// What all values together say: analysis/response/ (group delay, agreement, conformity).
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/response/comparison.hpp"
#include "analysis/response/conformity.hpp"
#include "analysis/response/group_delay.hpp"
#include "bindings.hpp"
#include "failure.hpp"

namespace dyncal::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;
using analysis::CombinedUncertainty;
using analysis::CommonPhaseUncertainty;
using analysis::Conformity;
using analysis::DecisionRule;
using analysis::Difference;
using analysis::GroupDelay;
using analysis::PhasePoint;

constexpr double infinite = analysis::infinite_degrees_of_freedom;

DecisionRule rule_named(const std::string& word) {
  for (const DecisionRule rule : {DecisionRule::simple_acceptance, DecisionRule::guard_band,
                                  DecisionRule::guard_band_non_binary}) {
    if (word == analysis::to_string(rule)) {
      return rule;
    }
  }
  refuse("rule is '" + word +
         "', but must be 'simple-acceptance', 'guard-band' or 'guard-band-non-binary'");
}

void bind_group_delay(nb::module_& module) {
  nb::class_<PhasePoint>(module, "PhasePoint",
                         "A phase, lead in rad modulo 2 pi; u_phase_rad: U / 2, independent from\n"
                         "point to point, with its k and degrees of freedom.\n"
                         "Source: analysis/response/group_delay.hpp")
      .def(
          "__init__",
          [](PhasePoint* self, double frequency_hz, double phase_rad, double u_phase_rad, double k,
             double degrees_of_freedom) {
            new (self) PhasePoint{frequency_hz, phase_rad, u_phase_rad, {k, degrees_of_freedom}};
          },
          "frequency_hz"_a, "phase_rad"_a, "u_phase_rad"_a, "k"_a = 2.0,
          "degrees_of_freedom"_a = infinite)
      .def_ro("frequency_hz", &PhasePoint::frequency_hz)
      .def_ro("phase_rad", &PhasePoint::phase_rad)
      .def_ro("u_phase_rad", &PhasePoint::u_phase_rad);
  nb::class_<CommonPhaseUncertainty>(
      module, "CommonPhaseUncertainty",
      "U / 2 of what all points share. Source: analysis/response/group_delay.hpp")
      .def(
          "__init__",
          [](CommonPhaseUncertainty* self, double delay_s, double phase_rad, double k_delay,
             double degrees_of_freedom_delay) {
            new (self)
                CommonPhaseUncertainty{delay_s, phase_rad, {k_delay, degrees_of_freedom_delay}};
          },
          "delay_s"_a = 0.0, "phase_rad"_a = 0.0, "k_delay"_a = 2.0,
          "degrees_of_freedom_delay"_a = infinite);
  nb::class_<GroupDelay>(module, "GroupDelay",
                         "psi(f) = psi_0 - 2 pi f tau. Source: analysis/response/group_delay.hpp")
      .def_ro("delay_s", &GroupDelay::delay_s, "tau = -d psi / d w, s")
      .def_ro("of_delay", &GroupDelay::of_delay)
      .def_ro("intercept_rad", &GroupDelay::intercept_rad, "psi_0")
      .def_ro("of_intercept", &GroupDelay::of_intercept)
      .def_ro("cov_delay_intercept", &GroupDelay::cov_delay_intercept, "s rad, as of U / 2")
      .def_ro("polarity_inverted", &GroupDelay::polarity_inverted)
      .def_ro("alternatives_s", &GroupDelay::alternatives_s, "delays that fit as well")
      .def_ro("chi_squared", &GroupDelay::chi_squared)
      .def_ro("degrees_of_freedom", &GroupDelay::degrees_of_freedom)
      .def_ro("unwrapped_rad", &GroupDelay::unwrapped_rad, "of all points")
      .def_ro("phase_covariance", &GroupDelay::phase_covariance, "V, row by row");
  module.def(
      "evaluate_group_delay",
      [](const std::vector<PhasePoint>& points, const CommonPhaseUncertainty& common) {
        return value_of(analysis::evaluate_group_delay(points, common));
      },
      "points"_a, "common"_a = CommonPhaseUncertainty{},
      "Group delay from phase over rising frequencies, by generalised least squares.\n"
      "\n"
      "Raises Error (invalid_argument, too_few_samples, not_converged: cannot be unwrapped).\n"
      "Source: analysis/response/group_delay.hpp");
}

void bind_agreement(nb::module_& module) {
  nb::class_<Difference>(module, "Difference",
                         "x - y with its uncertainty. Source: analysis/response/comparison.hpp")
      .def_ro("value", &Difference::value, "x - y")
      .def_ro("of_value", &Difference::of_value)
      .def_prop_ro("normalised_error", &Difference::normalised_error, "E_n; |E_n| <= 1: agree");
  module.def(
      "difference_of",
      [](double x, const CombinedUncertainty& of_x, double y, const CombinedUncertainty& of_y,
         double covariance) {
        return value_of(analysis::difference_of(x, of_x, y, of_y, covariance));
      },
      "x"_a, "of_x"_a, "y"_a, "of_y"_a, "covariance"_a = 0.0,
      "Do two results agree? covariance: of the standard uncertainties.\n"
      "\n"
      "Raises Error (invalid_argument). Source: ISO/IEC 17043, ISO 13528;\n"
      "analysis/response/comparison.hpp");
  nb::class_<Conformity>(module, "Conformity",
                         "What the rule says of a value and its tolerance.\n"
                         "Source: analysis/response/conformity.hpp")
      .def_prop_ro(
          "statement",
          [](const Conformity& self) { return std::string(analysis::to_string(self.statement)); })
      .def_ro("probability", &Conformity::probability, "that the value is within the tolerance")
      .def_ro("guard_band", &Conformity::guard_band, "w");
  module.def(
      "decide_conformity",
      [](double value, const CombinedUncertainty& of_value, double lower, double upper,
         const std::string& rule, double guard_factor) {
        return value_of(analysis::decide_conformity(value, of_value, {lower, upper},
                                                    rule_named(rule), guard_factor));
      },
      "value"_a, "of_value"_a, "lower"_a, "upper"_a, "rule"_a = "guard-band",
      "guard_factor"_a = 1.0,
      "Does a value conform to a tolerance?\n"
      "\n"
      "Raises Error (invalid_argument). Source: ILAC-G8:09/2019, JCGM 106:2012;\n"
      "analysis/response/conformity.hpp");
}

} // namespace

void bind_responses(nb::module_& module) {
  bind_group_delay(module);
  bind_agreement(module);
}

} // namespace dyncal::python
