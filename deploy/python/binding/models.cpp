// dyncal.models: parametric models of a response and filters that undo them (analysis/response/),
// a module of its own, since it alone needs Ceres. Its types are not those of dyncal._dyncal.
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/complex.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/response/compensation_filter.hpp"
#include "analysis/response/response_choice.hpp"
#include "arrays.hpp"
#include "failure.hpp"

namespace dyncal::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;
using analysis::CommonResponseUncertainty;
using analysis::CompensationFilter;
using analysis::FittedResponse;
using analysis::Loss;
using analysis::OtherDelay;
using analysis::ResponseCandidate;
using analysis::ResponseChoice;
using analysis::ResponseKind;
using analysis::ResponsePoint;
using analysis::ResponseResidual;
using analysis::ResponseUncertainty;

constexpr double infinite = analysis::infinite_degrees_of_freedom;

struct ModelParameter {
  std::string name;
  double value = 0.0;
  analysis::CombinedUncertainty of_value;
};

ResponseKind kind_named(const std::string& word) {
  std::string known;
  for (const ResponseKind kind : analysis::all_response_kinds) {
    if (word == name_of(kind)) {
      return kind;
    }
    known += (known.empty() ? "'" : ", '") + std::string(name_of(kind)) + "'";
  }
  refuse("kind is '" + word + "', but must be one of " + known);
}

Loss loss_named(const std::string& word) {
  if (word == "none" || word == "huber" || word == "tukey") {
    return word == "none" ? Loss::none : word == "huber" ? Loss::huber : Loss::tukey;
  }
  refuse("loss is '" + word + "', but must be 'none', 'huber' or 'tukey'");
}

std::string word_of(ResponseKind kind) {
  return std::string(name_of(kind));
}

std::vector<ModelParameter> parameters_of(const FittedResponse& fit) {
  std::vector<ModelParameter> list;
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    list.push_back({fit.names[i], fit.values[i], fit.of_values[i]});
  }
  return list;
}

void bind_measured(nb::module_& module) {
  nb::class_<ResponsePoint>(
      module, "ResponsePoint",
      "A measured value H of a response. u: U / 2, independent from point to point; relative of\n"
      "the magnitude, in rad of the phase (lead), each with its degrees of freedom.\n"
      "Source: analysis/response/response_model.hpp")
      .def(
          "__init__",
          [](ResponsePoint* self, double frequency_hz, std::complex<double> h,
             double u_magnitude_rel, double u_phase_rad, double magnitude_degrees_of_freedom,
             double phase_degrees_of_freedom) {
            new (self) ResponsePoint{frequency_hz,
                                     h,
                                     u_magnitude_rel,
                                     u_phase_rad,
                                     magnitude_degrees_of_freedom,
                                     phase_degrees_of_freedom};
          },
          "frequency_hz"_a, "h"_a, "u_magnitude_rel"_a, "u_phase_rad"_a,
          "magnitude_degrees_of_freedom"_a = infinite, "phase_degrees_of_freedom"_a = infinite)
      .def_ro("frequency_hz", &ResponsePoint::frequency_hz)
      .def_ro("h", &ResponsePoint::h)
      .def_ro("u_magnitude_rel", &ResponsePoint::u_magnitude_rel)
      .def_ro("u_phase_rad", &ResponsePoint::u_phase_rad);
  nb::class_<CommonResponseUncertainty>(
      module, "CommonResponseUncertainty",
      "U / 2 of what all points share: a gain, a delay in s, a phase in rad. It is no evidence\n"
      "against a model, and goes in full into the parameters.\n"
      "Source: analysis/response/response_fit.hpp")
      .def(
          "__init__",
          [](CommonResponseUncertainty* self, double gain_rel, double delay_s, double phase_rad) {
            new (self) CommonResponseUncertainty{gain_rel, delay_s, phase_rad};
          },
          "gain_rel"_a = 0.0, "delay_s"_a = 0.0, "phase_rad"_a = 0.0);
}

void bind_fit_parts(nb::module_& module) {
  nb::class_<ModelParameter>(module, "ModelParameter",
                             "A parameter of a model: 'gain' in the unit of H, 'delay_s',\n"
                             "'corner_hz', 'resonance_hz', 'damping'.\n"
                             "Source: analysis/response/response_model.hpp")
      .def_ro("name", &ModelParameter::name)
      .def_ro("value", &ModelParameter::value)
      .def_prop_ro("u", [](const ModelParameter& self) { return self.of_value.u; })
      .def_prop_ro("k", [](const ModelParameter& self) { return self.of_value.k; })
      .def_prop_ro(
          "expanded", [](const ModelParameter& self) { return self.of_value.expanded(); },
          "U = k u, 95.45 %")
      .def_prop_ro("degrees_of_freedom",
                   [](const ModelParameter& self) { return self.of_value.degrees_of_freedom; });
  nb::class_<ResponseResidual>(module, "ResponseResidual",
                               "Measured - model, of one point; own: without what is common.\n"
                               "Source: analysis/response/response_fit.hpp")
      .def_ro("magnitude_rel", &ResponseResidual::magnitude_rel)
      .def_ro("phase_rad", &ResponseResidual::phase_rad)
      .def_ro("own_magnitude_rel", &ResponseResidual::own_magnitude_rel)
      .def_ro("own_phase_rad", &ResponseResidual::own_phase_rad);
  nb::class_<OtherDelay>(module, "OtherDelay",
                         "Another minimum, whose chi-squared is higher by less than 9.\n"
                         "Source: analysis/response/response_fit.hpp")
      .def_ro("delay_s", &OtherDelay::delay_s)
      .def_ro("polarity_inverted", &OtherDelay::polarity_inverted)
      .def_ro("chi_squared", &OtherDelay::chi_squared);
  nb::class_<ResponseUncertainty>(module, "ResponseUncertainty",
                                  "U / 2 of the fitted model at a frequency.\n"
                                  "Source: analysis/response/response_fit.hpp")
      .def_ro("magnitude_rel", &ResponseUncertainty::magnitude_rel)
      .def_ro("phase_rad", &ResponseUncertainty::phase_rad);
}

void bind_fit(nb::module_& module) {
  nb::class_<FittedResponse>(
      module, "FittedResponse",
      "H(f) = g e^{-i 2 pi f tau} / (1 + i f / fc) / (1 - (f / f0)^2 + 2 i zeta f / f0), as far\n"
      "as its kind has these factors. Source: analysis/response/response_model.hpp")
      .def_prop_ro("kind", [](const FittedResponse& self) { return word_of(self.kind); })
      .def_prop_ro("parameters", &parameters_of, "in the order of the covariance")
      .def_ro("covariance", &FittedResponse::covariance, "of U / 2, row by row")
      .def_ro("chi_squared", &FittedResponse::chi_squared)
      .def_ro("degrees_of_freedom", &FittedResponse::degrees_of_freedom)
      .def_ro("residuals", &FittedResponse::residuals, "of each point")
      .def_ro("undetermined", &FittedResponse::undetermined, "names: not known to half of them")
      .def_ro("other_delays", &FittedResponse::other_delays, "by chi_squared")
      .def(
          "response_at",
          [](const FittedResponse& self, double frequency_hz) {
            return response_at(self.parameters, frequency_hz);
          },
          "frequency_hz"_a, "H of the model.")
      .def(
          "uncertainty_at",
          [](const FittedResponse& self, double frequency_hz) {
            return uncertainty_at(self, frequency_hz);
          },
          "frequency_hz"_a, "U / 2 of the model.");
  module.def(
      "fit_response",
      [](const std::string& kind, const std::vector<ResponsePoint>& points,
         const CommonResponseUncertainty& common, const std::string& loss) {
        return value_of(analysis::fit_response(kind_named(kind), points, common, loss_named(loss)));
      },
      "kind"_a, "points"_a, "common"_a = CommonResponseUncertainty{}, "loss"_a = "none",
      "A model of the kind by generalised least squares, with full covariance.\n"
      "\n"
      "kind: 'gain', 'delay', 'first_order', 'first_order_with_delay', 'second_order',\n"
      "'second_order_with_delay', 'second_and_first_order_with_delay'. loss: 'none', 'huber',\n"
      "'tukey'; these refuse a common uncertainty. Raises Error (invalid_argument,\n"
      "too_few_samples, not_finite, not_converged, ill_conditioned).\n"
      "Source: analysis/response/response_fit.hpp");
}

void bind_choice(nb::module_& module) {
  nb::class_<ResponseCandidate>(module, "ResponseCandidate",
                                "A kind that was tried, and how well it does.\n"
                                "Source: analysis/response/response_choice.hpp")
      .def_prop_ro("kind", [](const ResponseCandidate& self) { return word_of(self.kind); })
      .def_ro("fit", &ResponseCandidate::fit, "None: see problem")
      .def_ro("problem", &ResponseCandidate::problem)
      .def_ro("probability", &ResponseCandidate::probability,
              "that chance gives at least this chi-squared")
      .def_ro("aic", &ResponseCandidate::aic)
      .def_ro("bic", &ResponseCandidate::bic);
  nb::class_<ResponseChoice>(module, "ResponseChoice",
                             "Which order the values support; a choice is not a fit: see fits.\n"
                             "Source: analysis/response/response_choice.hpp")
      .def_prop_ro("best", &ResponseChoice::best, nb::rv_policy::reference_internal)
      .def_ro("fits", &ResponseChoice::fits, "False: P < 0.001 for the chosen kind")
      .def_ro("candidates", &ResponseChoice::candidates, "in the order of their kinds");
  module.def(
      "choose_response",
      [](const std::vector<ResponsePoint>& points, const CommonResponseUncertainty& common) {
        return value_of(analysis::choose_response(points, common));
      },
      "points"_a, "common"_a = CommonResponseUncertainty{},
      "The kind with the fewest parameters that no other beats by more than chance, as\n"
      "`dyncal model` chooses it.\n"
      "\n"
      "Raises Error as fit_response does, with the reason of the simplest kind.\n"
      "Source: analysis/response/response_choice.hpp");
}

void bind_filter(nb::module_& module) {
  nb::class_<CompensationFilter>(module, "CompensationFilter",
                                 "A digital filter C = B / A that undoes a response, delay_samples "
                                 "late.\n"
                                 "Source: analysis/response/compensation_filter.hpp")
      .def_prop_ro(
          "b", [](const CompensationFilter& self) { return to_numpy(self.b); }, nb::rv_policy::move,
          "float64 (taps,)")
      .def_prop_ro(
          "a", [](const CompensationFilter& self) { return to_numpy(self.a); }, nb::rv_policy::move,
          "float64 (poles + 1,)")
      .def_prop_ro(
          "covariance_b",
          [](const CompensationFilter& self) { return to_numpy(self.covariance_b); },
          nb::rv_policy::move, "float64 (taps * taps,), row by row")
      .def_ro("rate_hz", &CompensationFilter::rate_hz)
      .def_ro("cutoff_hz", &CompensationFilter::cutoff_hz, "end of the pass band")
      .def_ro("stop_hz", &CompensationFilter::stop_hz, "begin of the stop band")
      .def_ro("delay_samples", &CompensationFilter::delay_samples)
      .def_ro("ripple", &CompensationFilter::ripple, "max |C H e^{iwD} - 1| in the pass band")
      .def_ro("stop_gain", &CompensationFilter::stop_gain, "max |C g| in the stop band")
      .def_ro("noise_gain", &CompensationFilter::noise_gain, "of white noise, rms")
      .def(
          "response_at",
          [](const CompensationFilter& self, double frequency_hz) {
            return response_at(self, frequency_hz);
          },
          "frequency_hz"_a, "C(f) of the filter.");
  module.def(
      "design_compensation",
      [](const FittedResponse& response, double rate_hz, double cutoff_hz, int poles, int taps,
         std::optional<int> delay_samples) {
        return value_of(analysis::design_compensation(
            response, {rate_hz, cutoff_hz, poles, taps, delay_samples}));
      },
      "response"_a, nb::kw_only(), "rate_hz"_a, "cutoff_hz"_a, "poles"_a = 0, "taps"_a = 0,
      "delay_samples"_a = nb::none(),
      "The filter that undoes a fitted response in samples of rate_hz up to cutoff_hz.\n"
      "\n"
      "poles: 0 for FIR. taps: of B; 0: by the width between pass and stop band.\n"
      "delay_samples: None takes the one with the smallest error. Raises Error\n"
      "(invalid_argument). Source: Elster and Link 2008;\n"
      "analysis/response/compensation_filter.hpp");
}

} // namespace
} // namespace dyncal::python

NB_MODULE(models, module) {
  using namespace dyncal::python;
  module.doc() = "Parametric models of a response, and filters that undo them.\n"
                 "\n"
                 "Phase is lead, in rad; u of points are U / 2. Raises dyncal.Error.";
  bind_failure();
  bind_measured(module);
  bind_fit_parts(module);
  bind_fit(module);
  bind_choice(module);
  bind_filter(module);
}
