// Uncertainty: analysis/uncertainty/, coverage by GUM G.4, law of propagation, Monte Carlo.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "analysis/uncertainty/contribution.hpp"
#include "analysis/uncertainty/contribution_identifier.hpp"
#include "analysis/uncertainty/coverage.hpp"
#include "analysis/uncertainty/law_of_propagation.hpp"
#include "analysis/uncertainty/monte_carlo.hpp"
#include "bindings.hpp"
#include "failure.hpp"
#include "words.hpp"

namespace dyncal::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;
using analysis::CombinedUncertainty;
using analysis::Contribution;
using analysis::InputQuantity;
using analysis::MonteCarloResult;
using analysis::PropagatedUncertainty;
using analysis::UncertaintyPart;

constexpr double infinite = analysis::infinite_degrees_of_freedom;

CombinedUncertainty combine(const std::vector<UncertaintyPart>& parts) {
  for (const UncertaintyPart& part : parts) {
    if (!(part.u >= 0.0) || !(part.degrees_of_freedom > 0.0)) {
      refuse("each part needs u >= 0 and degrees of freedom above 0");
    }
  }
  return analysis::combine(parts);
}

double coverage_factor(double degrees_of_freedom, double probability) {
  if (!(degrees_of_freedom > 0.0) || !(probability > 0.0 && probability < 1.0)) {
    refuse("degrees_of_freedom must be above 0, probability between 0 and 1");
  }
  return analysis::coverage_factor(degrees_of_freedom, probability);
}

std::vector<analysis::InputCorrelation>
correlations_of(const std::vector<std::tuple<std::size_t, std::size_t, double>>& correlations) {
  std::vector<analysis::InputCorrelation> list;
  for (const auto& [first, second, coefficient] : correlations) {
    list.push_back({first, second, coefficient});
  }
  return list;
}

std::vector<MonteCarloResult>
propagate_distributions(const std::vector<InputQuantity>& inputs, const nb::callable& model,
                        std::size_t outputs,
                        const std::vector<std::tuple<std::size_t, std::size_t, double>>& pairs,
                        std::uint64_t seed, std::size_t max_trials, double probability) {
  const analysis::MeasurementModel in_python = [&](std::span<const double> drawn,
                                                   std::span<double> filled) {
    nb::list values;
    for (const double value : drawn) {
      values.append(value);
    }
    const auto given = nb::cast<std::vector<double>>(model(values));
    if (given.size() != filled.size()) {
      refuse("the model gave " + std::to_string(given.size()) + " outputs, not " +
             std::to_string(filled.size()));
    }
    std::copy(given.begin(), given.end(), filled.begin());
  };
  return value_of(analysis::propagate_distributions(
      inputs, correlations_of(pairs), outputs, in_python, {seed, max_trials, probability, {}}));
}

void bind_coverage(nb::module_& module) {
  nb::class_<UncertaintyPart>(module, "UncertaintyPart",
                              "A standard uncertainty and how well it is known.\n"
                              "Source: analysis/uncertainty/coverage.hpp")
      .def(
          "__init__",
          [](UncertaintyPart* self, double u, double degrees_of_freedom) {
            new (self) UncertaintyPart{u, degrees_of_freedom};
          },
          "u"_a, "degrees_of_freedom"_a = infinite)
      .def_ro("u", &UncertaintyPart::u)
      .def_ro("degrees_of_freedom", &UncertaintyPart::degrees_of_freedom);
  nb::class_<CombinedUncertainty>(module, "CombinedUncertainty",
                                  "Combined standard uncertainty u, nu_eff, and k at 95.45 %.\n"
                                  "Source: analysis/uncertainty/coverage.hpp")
      .def(
          "__init__",
          [](CombinedUncertainty* self, double u, double degrees_of_freedom, double k) {
            new (self) CombinedUncertainty{u, degrees_of_freedom, k};
          },
          "u"_a, "degrees_of_freedom"_a = infinite, "k"_a = 2.0)
      .def_ro("u", &CombinedUncertainty::u, "standard uncertainty, U / k")
      .def_ro("degrees_of_freedom", &CombinedUncertainty::degrees_of_freedom, "nu_eff")
      .def_ro("k", &CombinedUncertainty::k, "at 95.45 %")
      .def_prop_ro("expanded", &CombinedUncertainty::expanded, "U = k u")
      .def("__repr__", [](const CombinedUncertainty& self) {
        return "CombinedUncertainty(u=" + std::to_string(self.u) +
               ", degrees_of_freedom=" + std::to_string(self.degrees_of_freedom) +
               ", k=" + std::to_string(self.k) + ")";
      });
  module.def("combine", &combine, "parts"_a,
             "Independent parts to u, nu_eff and k at 95.45 %: Welch-Satterthwaite.\n"
             "\n"
             "Raises Error (invalid_argument). Source: GUM G.4; analysis/uncertainty/coverage.hpp");
  module.def("coverage_factor", &coverage_factor, "degrees_of_freedom"_a,
             "probability"_a = analysis::two_sigma_probability,
             "k with |t| <= k at the probability (Student's t); 2 for infinite degrees of\n"
             "freedom at 95.45 %. Raises Error (invalid_argument). Source: GUM G.3, G.4");
  module.def(
      "standard_uncertainty",
      [](const std::string& distribution, double half_width) {
        return analysis::standard_uncertainty(distribution_of(distribution), half_width);
      },
      "distribution"_a, "half_width"_a,
      "Of an interval: 'normal' (95.45 %), 'rectangular', 'triangular', 'arcsine'.\n"
      "\n"
      "Raises Error (invalid_argument). Source: GUM 4.3, JCGM 101, 6.4");
}

void bind_contribution(nb::module_& module) {
  nb::class_<Contribution>(module, "Contribution",
                           "A row of an uncertainty budget: standard uncertainties, already\n"
                           "multiplied by their sensitivity, so that rows add in squares.\n"
                           "Source: GUM 5.1.2; analysis/uncertainty/contribution.hpp")
      .def(
          "__init__",
          [](Contribution* self, const std::string& subject, double u_magnitude_rel,
             double u_phase_rad, const std::string& distribution, const std::string& repeats,
             double degrees_of_freedom) {
            new (self) Contribution{
                .subject = subject,
                .distribution = distribution_of(distribution),
                .repeats = repeats_named(repeats),
                .degrees_of_freedom = degrees_of_freedom,
                .u_magnitude_rel = u_magnitude_rel,
                .u_phase_rad = u_phase_rad,
            };
          },
          "subject"_a, nb::kw_only(), "u_magnitude_rel"_a = 0.0, "u_phase_rad"_a = 0.0,
          "distribution"_a = "normal", "repeats"_a = "common", "degrees_of_freedom"_a = infinite,
          "A row of one's own. repeats: 'anew' (in every repetition), 'common', or\n"
          "'common_delay' (moreover the same error of time at all frequencies).")
      .def_prop_ro(
          "kind",
          [](const Contribution& row) { return std::string(analysis::identifier_of(row.kind)); },
          "as in result files: 'fit_noise'")
      .def_ro("subject", &Contribution::subject, "completes the kind: which channel")
      .def_prop_ro("name", &Contribution::name, "for people")
      .def_prop_ro("distribution",
                   [](const Contribution& row) {
                     return std::string(analysis::to_string(row.distribution));
                   })
      .def_prop_ro("repeats",
                   [](const Contribution& row) { return std::string(word_of(row.repeats)); })
      .def_ro("degrees_of_freedom", &Contribution::degrees_of_freedom)
      .def_ro("u_magnitude_rel", &Contribution::u_magnitude_rel, "relative")
      .def_ro("u_phase_rad", &Contribution::u_phase_rad, "rad")
      .def_ro("u_lasting_magnitude_rel", &Contribution::u_lasting_magnitude_rel,
              "part of u_magnitude_rel that is the same in all repetitions");
  module.def(
      "contribution_identifier",
      [](const std::string& name) {
        for (int i = 0; i <= static_cast<int>(analysis::ContributionKind::other); ++i) {
          const auto kind = static_cast<analysis::ContributionKind>(i);
          if (name == analysis::to_string(kind)) {
            return std::string(analysis::identifier_of(kind));
          }
        }
        return name;
      },
      "name"_a,
      "'fit_noise' for \"noise of\", as result files of version 1 name kinds; a name that is not\n"
      "known is left. Source: analysis/uncertainty/contribution_identifier.hpp");
}

void bind_propagation(nb::module_& module) {
  nb::class_<InputQuantity>(
      module, "InputQuantity",
      "An input of a measurement model. Source: analysis/uncertainty/law_of_propagation.hpp")
      .def(
          "__init__",
          [](InputQuantity* self, const std::string& name, double value, double u,
             double sensitivity, const std::string& distribution, double degrees_of_freedom) {
            new (self) InputQuantity{
                name, value, u, sensitivity, distribution_of(distribution), degrees_of_freedom};
          },
          "name"_a, "value"_a = 0.0, "u"_a = 0.0, nb::kw_only(), "sensitivity"_a = 1.0,
          "distribution"_a = "normal", "degrees_of_freedom"_a = infinite,
          "u: standard uncertainty, whatever the distribution; sensitivity: d result / d input.")
      .def_ro("name", &InputQuantity::name)
      .def_ro("value", &InputQuantity::value)
      .def_ro("u", &InputQuantity::u)
      .def_ro("sensitivity", &InputQuantity::sensitivity)
      .def_ro("degrees_of_freedom", &InputQuantity::degrees_of_freedom);
  nb::class_<PropagatedUncertainty>(module, "PropagatedUncertainty",
                                    "Of the output of a model, by the law of propagation.\n"
                                    "Source: analysis/uncertainty/law_of_propagation.hpp")
      .def_ro("u", &PropagatedUncertainty::u)
      .def_ro("degrees_of_freedom", &PropagatedUncertainty::degrees_of_freedom, "nu_eff")
      .def_ro("k", &PropagatedUncertainty::k, "at 95.45 %")
      .def_ro("expanded", &PropagatedUncertainty::expanded, "U = k u")
      .def_ro("contributions", &PropagatedUncertainty::contributions, "c_i u_i");
  module.def(
      "propagate_uncertainty",
      [](const std::vector<InputQuantity>& inputs,
         const std::vector<std::tuple<std::size_t, std::size_t, double>>& correlations) {
        return value_of(analysis::propagate_uncertainty(inputs, correlations_of(correlations)));
      },
      "inputs"_a, "correlations"_a = nb::list(),
      "Law of propagation with correlated inputs: (first, second, coefficient) each.\n"
      "\n"
      "Raises Error (invalid_argument). Source: GUM 5.2.2, G.4;\n"
      "analysis/uncertainty/law_of_propagation.hpp");
  nb::class_<MonteCarloResult>(module, "MonteCarloResult",
                               "Of one output. Source: analysis/uncertainty/monte_carlo.hpp")
      .def_ro("mean", &MonteCarloResult::mean)
      .def_ro("u", &MonteCarloResult::u, "standard deviation of the trials")
      .def_ro("low", &MonteCarloResult::low, "of the coverage interval")
      .def_ro("high", &MonteCarloResult::high)
      .def_ro("trials", &MonteCarloResult::trials)
      .def_ro("stable", &MonteCarloResult::stable, "the adaptive criterion was met");
  module.def("propagate_distributions", &propagate_distributions, "inputs"_a, "model"_a,
             "outputs"_a = 1, nb::kw_only(), "correlations"_a = nb::list(), "seed"_a = 1,
             "max_trials"_a = 1'000'000, "probability"_a = analysis::two_sigma_probability,
             nb::sig("def propagate_distributions(inputs: "
                     "collections.abc.Sequence[InputQuantity], model: "
                     "collections.abc.Callable[[list[float]], collections.abc.Sequence[float]], "
                     "outputs: int = 1, *, correlations: "
                     "collections.abc.Sequence[tuple[int, int, float]] = [], seed: int = 1, "
                     "max_trials: int = 1000000, probability: float = 0.9544997361036416) -> "
                     "list[MonteCarloResult]"),
             "Monte Carlo propagation, adaptive. model(values) gives the outputs; what it raises\n"
             "is raised. The same seed gives the same numbers.\n"
             "\n"
             "Raises Error (invalid_argument, not_finite). Source: JCGM 101:2008, 5 to 7, 7.9;\n"
             "analysis/uncertainty/monte_carlo.hpp");
}

} // namespace

void bind_uncertainty(nb::module_& module) {
  bind_coverage(module);
  bind_contribution(module);
  bind_propagation(module);
}

} // namespace dyncal::python
