// Sine approximation: analysis/sine/ and analysis/method/record_fit.hpp.
#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/complex.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/method/record_fit.hpp"
#include "analysis/sine.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "frequency_argument.hpp"

namespace dyncal::python {
namespace {

using namespace nb::literals;
using analysis::FrequencyFit;
using analysis::SineFit;
using ChannelList = nb::typed<nb::list, Array<double>>;
using ChannelsByName = nb::typed<nb::dict, nb::str, Array<double>>;

Columns columns_of(const nb::list& channels) {
  Columns columns;
  std::size_t number = 0;
  for (const nb::handle channel : channels) {
    columns.add("channels[" + std::to_string(number++) + "]", channel);
  }
  return columns;
}

Columns columns_of(const nb::dict& channels) {
  Columns columns;
  for (const auto& [name, channel] : channels) {
    columns.add("channel '" + nb::cast<std::string>(nb::str(name)) + "'", channel);
  }
  return columns;
}

nb::typed<nb::dict, nb::str, SineFit> by_name(const nb::dict& channels, std::vector<SineFit> fits) {
  nb::dict named;
  std::size_t number = 0;
  for (const auto& [name, channel] : channels) {
    named[name] = nb::cast(std::move(fits[number++]));
  }
  return named;
}

std::vector<SineFit> fit_known(const FrequencyArgument& argument, Array<std::int64_t>& stamps_ns,
                               const Columns& columns, std::optional<std::int64_t> origin_ns) {
  const analysis::Frequency frequency = argument.frequency();
  const auto stamps = stamps_ns.span("stamps_ns");
  const std::int64_t origin = origin_ns.value_or(stamps.empty() ? 0 : stamps.front());
  const nb::gil_scoped_release released;
  return value_of(analysis::fit_sine(frequency, origin, stamps, columns.spans));
}

FrequencyFit fit_frequency(const FrequencyArgument& start, Array<std::int64_t>& stamps_ns,
                           const Columns& columns, double search_rel,
                           std::optional<std::int64_t> origin_ns) {
  const analysis::Frequency frequency = start.frequency();
  const auto stamps = stamps_ns.span("stamps_ns");
  const std::int64_t origin = origin_ns.value_or(stamps.empty() ? 0 : stamps.front());
  const nb::gil_scoped_release released;
  return value_of(
      analysis::fit_sine_and_frequency(frequency, search_rel, origin, stamps, columns.spans));
}

analysis::ExtendedBasis basis_of(int drift, int harmonics,
                                 const std::vector<FrequencyArgument>& lines,
                                 bool drifting_phasor) {
  if (drift < 0 || drift > 8 || harmonics < 1 || harmonics > 50) {
    refuse("drift must be 0 to 8, harmonics 1 to 50");
  }
  analysis::ExtendedBasis basis{drift, harmonics, {}, drifting_phasor};
  for (const FrequencyArgument& line : lines) {
    basis.lines.push_back(line.frequency());
  }
  return basis;
}

analysis::Weighting weighting_of(const std::string& name) {
  if (name == "none") {
    return analysis::Weighting::none;
  }
  if (name == "huber") {
    return analysis::Weighting::huber;
  }
  if (name == "tukey") {
    return analysis::Weighting::tukey;
  }
  refuse("weighting is '" + name + "', but must be 'none', 'huber' or 'tukey'");
}

std::vector<analysis::ExtendedFit>
fit_extended(const FrequencyArgument& argument, Array<std::int64_t>& stamps_ns,
             const ChannelList& channels, int drift, int harmonics,
             const std::vector<FrequencyArgument>& lines, bool drifting_phasor,
             const std::string& weighting, std::optional<std::int64_t> origin_ns) {
  const analysis::Frequency frequency = argument.frequency();
  const auto basis = basis_of(drift, harmonics, lines, drifting_phasor);
  const auto weights = weighting_of(weighting);
  const auto stamps = stamps_ns.span("stamps_ns");
  const Columns columns = columns_of(channels);
  const std::int64_t origin = origin_ns.value_or(stamps.empty() ? 0 : stamps.front());
  const nb::gil_scoped_release released;
  return value_of(
      analysis::fit_sine_extended(frequency, basis, weights, origin, stamps, columns.spans));
}

analysis::RecordFit fit_record(Array<std::int64_t>& stamps_ns, const ChannelList& channels,
                               const std::optional<FrequencyArgument>& argument, int drift,
                               int harmonics, const std::vector<FrequencyArgument>& lines,
                               std::optional<std::int64_t> origin_ns) {
  analysis::RecordFitSettings settings;
  if (argument) {
    settings.frequency = argument->frequency();
  }
  settings.basis = basis_of(drift, harmonics, lines, false);
  settings.phase_origin_ns = origin_ns;
  const auto stamps = stamps_ns.span("stamps_ns");
  const Columns columns = columns_of(channels);
  const nb::gil_scoped_release released;
  return value_of(analysis::fit_record(settings, stamps, columns.spans));
}

void bind_frequency(nb::module_& module) {
  using analysis::Frequency;
  nb::class_<Frequency>(module, "Frequency",
                        "A frequency that keeps the digits it was written with, some 32 of them.\n"
                        "\n"
                        "Frequency(\"199.87\") is exact where the number 199.87 is not; a number\n"
                        "is taken as the double that it is. Units: Hz. Raises Error\n"
                        "(frequency_out_of_range, invalid_argument).\n"
                        "Source: analysis/base/frequency.hpp")
      .def(
          "__init__",
          [](Frequency* self, const FrequencyArgument& hz) {
            new (self) Frequency(hz.frequency());
          },
          "hz"_a)
      .def_prop_ro("hz", &Frequency::hz, "Hz, as a double")
      .def("shifted_by_hz", &Frequency::shifted_by_hz, "delta_hz"_a,
           "This frequency plus a small amount in Hz, which keeps the digits.")
      .def("__repr__", [](const Frequency& self) {
        return "Frequency(" + nb::cast<std::string>(nb::repr(nb::float_(self.hz()))) + ")";
      });
}

void bind_sine_fit(nb::module_& module) {
  nb::class_<SineFit>(
      module, "SineFit",
      "y = A sin(w (t - t_0)) + B cos(w (t - t_0)) + C, fitted by least squares.\n"
      "\n"
      "Phase is lead in rad (a delay is negative): y = amplitude sin(w (t - t_0) +\n"
      "phase_rad) + C. Uncertainties are standard ones from the residuals: white\n"
      "noise. Source: paper eq. (1), ISO 16063-11 method 3, IEEE 1057.")
      .def_ro("sine", &SineFit::sine, "A, in the unit of the values")
      .def_ro("cosine", &SineFit::cosine, "B, in the unit of the values")
      .def_ro("offset", &SineFit::offset, "C, in the unit of the values")
      .def_ro("covariance", &SineFit::covariance, "of (A, B, C): AA, AB, AC, BB, BC, CC")
      .def_ro("rss", &SineFit::rss, "residual sum of squares")
      .def_ro("samples", &SineFit::samples)
      .def_ro("degrees_of_freedom", &SineFit::degrees_of_freedom)
      .def_prop_ro("amplitude", &SineFit::amplitude, "|P|, in the unit of the values")
      .def_prop_ro("phase_rad", &SineFit::phase_rad, "arg P = atan2(B, A): lead, in (-pi, pi]")
      .def_prop_ro("u_amplitude", &SineFit::u_amplitude, "standard uncertainty")
      .def_prop_ro("u_phase_rad", &SineFit::u_phase_rad, "standard uncertainty, rad")
      .def_prop_ro("residual_sd", &SineFit::residual_sd, "in the unit of the values")
      .def_prop_ro(
          "phasor", [](const SineFit& fit) { return std::complex(fit.sine, fit.cosine); },
          "P = A + iB")
      .def("__repr__", [](const SineFit& fit) {
        return "SineFit(amplitude=" + std::to_string(fit.amplitude()) +
               ", phase_rad=" + std::to_string(fit.phase_rad()) +
               ", offset=" + std::to_string(fit.offset) + ")";
      });
  nb::class_<FrequencyFit>(module, "FrequencyFit",
                           "A sine whose frequency was fitted, too, shared by all channels.\n"
                           "Source: analysis/sine/sine_fit.hpp")
      .def_ro("frequency", &FrequencyFit::frequency, "refined, with all its digits")
      .def_ro("u_frequency_hz", &FrequencyFit::u_frequency_hz, "Hz, for white noise")
      .def_ro("channels", &FrequencyFit::channels, "at that frequency, in the order given")
      .def_ro("iterations", &FrequencyFit::iterations);
}

void bind_further_fits(nb::module_& module) {
  using analysis::ExtendedFit;
  using analysis::FurtherPhasor;
  using analysis::RecordFit;
  nb::class_<FurtherPhasor>(
      module, "FurtherPhasor",
      "A harmonic or a line beside the sine. Source: analysis/sine/extended_sine_fit.hpp")
      .def_ro("frequency_hz", &FurtherPhasor::frequency_hz, "Hz")
      .def_ro("sine", &FurtherPhasor::sine)
      .def_ro("cosine", &FurtherPhasor::cosine)
      .def_ro("u_sine", &FurtherPhasor::u_sine)
      .def_ro("u_cosine", &FurtherPhasor::u_cosine);
  nb::class_<ExtendedFit>(module, "ExtendedFit",
                          "A sine beside drift, harmonics and lines.\n"
                          "Source: analysis/sine/extended_sine_fit.hpp has the model.")
      .def_ro("fundamental", &ExtendedFit::fundamental, "covariance of the whole model")
      .def_ro("drift", &ExtendedFit::drift, "d_1, d_2, ... in the unit of the values")
      .def_ro("u_drift", &ExtendedFit::u_drift)
      .def_ro("harmonics", &ExtendedFit::harmonics, "from the second one on")
      .def_ro("lines", &ExtendedFit::lines, "in the order given")
      .def_ro("phasor_drift", &ExtendedFit::phasor_drift, "A', B' per half record")
      .def_ro("outliers", &ExtendedFit::outliers, "samples with less than half the weight")
      .def_ro("iterations", &ExtendedFit::iterations, "of the weights");
  nb::class_<RecordFit>(
      module, "RecordFit",
      "What `dyncal fit` states of a record. Source: analysis/method/record_fit.hpp")
      .def_ro("frequency", &RecordFit::frequency)
      .def_ro("u_frequency_hz", &RecordFit::u_frequency_hz, "Hz; None: the frequency was given")
      .def_ro("phase_origin_ns", &RecordFit::phase_origin_ns, "t_0 of the phases, ns")
      .def_ro("fits", &RecordFit::fits, "in the order of the channels")
      .def_ro("shortening_rel", &RecordFit::shortening_rel,
              "of each amplitude, put back; 0: nothing to be seen");
}

constexpr const char* fit_sine_doc =
    "Three-parameter sine fit at a known frequency.\n"
    "\n"
    "frequency: Hz; text keeps its digits (\"79.98\"), a number is the double itself.\n"
    "stamps_ns: int64 (n,), strictly increasing, any spacing.\n"
    "channels: float64 (n,); or a list or dict of such, fitted each on its own over the same\n"
    "stamps. list(y) of a C-ordered (k, n) array is one. Nothing is copied nor converted.\n"
    "reference_ns: the instant t_0 of the phases; None: the first stamp.\n"
    "\n"
    "Raises Error: too_few_samples (n <= 3), stamps_not_increasing, not_finite,\n"
    "frequency_out_of_range, ill_conditioned, no_excitation, invalid_argument. The GIL is\n"
    "released. Source: paper eq. (1), ISO 16063-11 method 3; analysis/sine/sine_fit.hpp";

void bind_known_frequency(nb::module_& module) {
  const auto reference = "reference_ns"_a = nb::none();
  module.def(
      "fit_sine",
      [](const FrequencyArgument& frequency, Array<std::int64_t> stamps_ns,
         const ChannelsByName& channels, std::optional<std::int64_t> reference_ns) {
        return by_name(channels,
                       fit_known(frequency, stamps_ns, columns_of(channels), reference_ns));
      },
      "frequency"_a, "stamps_ns"_a, "channels"_a, reference, fit_sine_doc);
  module.def(
      "fit_sine",
      [](const FrequencyArgument& frequency, Array<std::int64_t> stamps_ns,
         const ChannelList& channels, std::optional<std::int64_t> reference_ns) {
        return fit_known(frequency, stamps_ns, columns_of(channels), reference_ns);
      },
      "frequency"_a, "stamps_ns"_a, "channels"_a, reference);
  module.def(
      "fit_sine",
      [](const FrequencyArgument& frequency, Array<std::int64_t> stamps_ns,
         const Array<double>& channels, std::optional<std::int64_t> reference_ns) {
        Columns columns;
        columns.add("channels", channels.object());
        return fit_known(frequency, stamps_ns, columns, reference_ns).front();
      },
      "frequency"_a, "stamps_ns"_a, "channels"_a, reference);
}

} // namespace

void bind_sines(nb::module_& module) {
  bind_frequency(module);
  bind_sine_fit(module);
  bind_further_fits(module);
  bind_known_frequency(module);
  module.def(
      "fit_sine_and_frequency",
      [](const FrequencyArgument& start, Array<std::int64_t> stamps_ns, const ChannelList& channels,
         double search_rel, std::optional<std::int64_t> reference_ns) {
        return fit_frequency(start, stamps_ns, columns_of(channels), search_rel, reference_ns);
      },
      "start"_a, "stamps_ns"_a, "channels"_a, nb::kw_only(), "search_rel"_a = 5e-3,
      "reference_ns"_a = nb::none(),
      "Four-parameter sine fit: the frequency too, shared by all channels.\n"
      "\n"
      "start: Hz, right to `search_rel` (relative). Shapes, units and errors as fit_sine; also\n"
      "raises Error (not_converged). Source: IEEE 1057; analysis/sine/sine_fit.hpp");
  module.def(
      "estimate_frequency",
      [](Array<std::int64_t> stamps_ns, const ChannelList& channels) {
        const auto stamps = stamps_ns.span("stamps_ns");
        const Columns columns = columns_of(channels);
        const nb::gil_scoped_release released;
        return value_of(analysis::estimate_frequency(stamps, columns.spans));
      },
      "stamps_ns"_a, "channels"_a,
      "The frequency of a sine of which nothing is known, to about a bin 1/T.\n"
      "\n"
      "stamps_ns: int64 (n,); channels: list of float64 (n,). Raises Error (too_few_samples,\n"
      "not_finite, stamps_not_increasing, no_excitation).\n"
      "Source: Grandke 1983; analysis/sine/frequency_estimate.hpp");
  module.def("fit_sine_extended", &fit_extended, "frequency"_a, "stamps_ns"_a, "channels"_a,
             nb::kw_only(), "drift"_a = 0, "harmonics"_a = 1,
             "lines"_a = std::vector<FrequencyArgument>{}, "drifting_phasor"_a = false,
             "weighting"_a = "none", "reference_ns"_a = nb::none(),
             "Sine fit beside a drift (highest power), harmonics (highest), and further lines\n"
             "(Hz): hum, or the other sines of a record with several.\n"
             "\n"
             "weighting: 'none', 'huber' or 'tukey' (robust). Shapes, units and errors as\n"
             "fit_sine. Source: analysis/sine/extended_sine_fit.hpp");
  module.def("fit_record", &fit_record, "stamps_ns"_a, "channels"_a, "frequency"_a = nb::none(),
             nb::kw_only(), "drift"_a = 0, "harmonics"_a = 1,
             "lines"_a = std::vector<FrequencyArgument>{}, "reference_ns"_a = nb::none(),
             "What `dyncal fit` states of a record, to the last bit: fit_sine, with what scatter\n"
             "and beat of the stamps do to amplitude and covariance.\n"
             "\n"
             "frequency: Hz; None: estimated and fitted. Shapes, units and errors as fit_sine.\n"
             "Source: analysis/method/record_fit.hpp");
}

} // namespace dyncal::python
