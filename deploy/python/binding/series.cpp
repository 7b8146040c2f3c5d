// Series time stamping: analysis/method/series_stamping.hpp.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/method/series_stamping.hpp"
#include "bindings.hpp"
#include "channels.hpp"
#include "frequency_argument.hpp"

namespace dyncal::python {
namespace {

using namespace nb::literals;
using analysis::NominalFrequency;
using analysis::SeriesChannelResult;
using analysis::SeriesStampingResult;

// A shot as Python gives it.
struct Shot {
  double dso_first_s = 0.0;
  double dso_interval_s = 0.0;
  Array<double> dso_sync;
  Columns series;
};

struct SeriesUncertainty {
  double dso_delay_s = 0.0;
  double dso_rate_rel = 0.0;
  double start_latency_s = 0.0;
  double start_scatter_s = 0.0;
  double reference_magnitude_rel = 0.0;
  double reference_phase_rad = 0.0;
  double acs_delay_s = 0.0;
};

void set_uncertainty(const SeriesUncertainty& systematic, analysis::SeriesStampingInput& input) {
  input.u_dso_delay_s = systematic.dso_delay_s;
  input.u_dso_rate_rel = systematic.dso_rate_rel;
  input.u_start_latency_s = systematic.start_latency_s;
  input.start_scatter_s = systematic.start_scatter_s;
  input.reference_magnitude_rel = systematic.reference_magnitude_rel;
  input.reference_phase_rad = systematic.reference_phase_rad;
  input.acs_delay_s = systematic.acs_delay_s;
}

SeriesStampingResult
series_stamping(const FrequencyArgument& frequency, Array<std::int64_t>& acs_stamps_ns,
                Channel reference, Channel sync_acs, const std::vector<std::string>& channels,
                double nominal_rate_hz, std::vector<Shot> shots, double dso_delay_s,
                double start_latency_s, double reference_delay_s,
                const analysis::ReferenceResponse& reference_response,
                const SeriesUncertainty& systematic, double frequency_search_rel) {
  analysis::SeriesStampingInput input{.frequency = frequency.frequency()};
  input.frequency_search_rel = frequency_search_rel;
  input.acs_stamps_ns = acs_stamps_ns.span("acs_stamps_ns");
  input.reference = reference.samples();
  input.sync_acs = sync_acs.samples();
  input.channels = channels;
  input.nominal_rate_hz = nominal_rate_hz;
  for (Shot& shot : shots) {
    if (shot.series.spans.size() != channels.size()) {
      refuse("a shot has " + std::to_string(shot.series.spans.size()) + " series, but there are " +
             std::to_string(channels.size()) + " channels");
    }
    input.shots.push_back(
        {shot.dso_first_s, shot.dso_interval_s, shot.dso_sync.span("dso_sync"), shot.series.spans});
  }
  input.dso_delay_s = dso_delay_s;
  input.start_latency_s = start_latency_s;
  input.reference_delay_s = reference_delay_s;
  input.reference_response = reference_response;
  set_uncertainty(systematic, input);
  const nb::gil_scoped_release released;
  return value_of(analysis::evaluate_series_stamping(input));
}

void bind_shot(nb::module_& module) {
  nb::class_<Shot>(module, "SeriesShot",
                   "One shot: the oscilloscope's trace of sync, and the series that the sensor\n"
                   "recorded after the trigger. Source: analysis/method/series_stamping.hpp")
      .def(
          "__init__",
          [](Shot* self, double dso_first_s, double dso_interval_s, const Array<double>& dso_sync,
             const nb::typed<nb::list, Array<double>>& series) {
            Shot shot{dso_first_s, dso_interval_s, dso_sync, {}};
            static_cast<void>(shot.dso_sync.span("dso_sync"));
            for (const nb::handle one : series) {
              shot.series.add("series[" + std::to_string(shot.series.spans.size()) + "]", one);
            }
            new (self) Shot(std::move(shot));
          },
          nb::kw_only(), "dso_first_s"_a, "dso_interval_s"_a, "dso_sync"_a, "series"_a,
          "dso_first_s: of the trace's first sample, 0 at the trigger point; dso_sync: float64\n"
          "(m,); series: float64 (n,) each, one a channel of the sensor.");
  nb::class_<SeriesUncertainty>(module, "SeriesUncertainty",
                                "Standard uncertainties that no residual shows.\n"
                                "Source: analysis/method/series_stamping.hpp")
      .def(
          "__init__",
          [](SeriesUncertainty* self, double dso_delay_s, double dso_rate_rel,
             double start_latency_s, double start_scatter_s, double reference_magnitude_rel,
             double reference_phase_rad, double acs_delay_s) {
            new (self) SeriesUncertainty{dso_delay_s,
                                         dso_rate_rel,
                                         start_latency_s,
                                         start_scatter_s,
                                         reference_magnitude_rel,
                                         reference_phase_rad,
                                         acs_delay_s};
          },
          nb::kw_only(), "dso_delay_s"_a = 0.0, "dso_rate_rel"_a = 0.0, "start_latency_s"_a = 0.0,
          "start_scatter_s"_a = 0.0, "reference_magnitude_rel"_a = 0.0,
          "reference_phase_rad"_a = 0.0, "acs_delay_s"_a = 0.0);
}

} // namespace

void bind_series(nb::module_& module) {
  bind_shot(module);
  nb::class_<NominalFrequency>(module, "NominalFrequency",
                               "The real sample rate from the apparent frequency, paper (6), (9).\n"
                               "Source: analysis/method/nominal_frequency.hpp")
      .def_ro("apparent_hz", &NominalFrequency::apparent_hz)
      .def_ro("u_apparent_hz", &NominalFrequency::u_apparent_hz)
      .def_ro("lambda_", &NominalFrequency::lambda)
      .def_ro("real_rate_hz", &NominalFrequency::real_rate_hz)
      .def_ro("u_real_rate_hz", &NominalFrequency::u_real_rate_hz);
  // Repetition and RepetitionMean are repetitions.cpp's.
  nb::class_<SeriesChannelResult>(module, "SeriesChannelResult",
                                  "A channel of a series sensor: its shots and their mean.\n"
                                  "Source: analysis/method/series_stamping.hpp")
      .def_ro("channel", &SeriesChannelResult::channel)
      .def_ro("shots", &SeriesChannelResult::shots, "a Repetition each")
      .def_ro("mean", &SeriesChannelResult::mean)
      .def_ro("common_budget", &SeriesChannelResult::common_budget, "what all shots share");
  nb::class_<SeriesStampingResult>(
      module, "SeriesStampingResult",
      "What the shots of one frequency say together. Phases in rad, lead.\n"
      "Source: analysis/method/series_stamping.hpp")
      .def_ro("reference", &SeriesStampingResult::reference)
      .def_ro("sync_acs", &SeriesStampingResult::sync_acs)
      .def_ro("trigger_phase_rad", &SeriesStampingResult::trigger_phase_rad, "beta of each shot")
      .def_ro("u_trigger_phase_rad", &SeriesStampingResult::u_trigger_phase_rad)
      .def_ro("rate", &SeriesStampingResult::rate)
      .def_ro("channels", &SeriesStampingResult::channels);
  module.def("evaluate_series_stamping", &series_stamping, "frequency"_a, nb::kw_only(),
             "acs_stamps_ns"_a, "reference"_a, "sync_acs"_a, "channels"_a, "nominal_rate_hz"_a,
             "shots"_a, "dso_delay_s"_a = 0.0, "start_latency_s"_a = 0.0,
             "reference_delay_s"_a = 0.0, "reference_response"_a = analysis::ReferenceResponse{},
             "systematic"_a = SeriesUncertainty{}, "frequency_search_rel"_a = 1e-3,
             "Series time stamping: H of a sensor that records series after a trigger.\n"
             "\n"
             "frequency: nominal, Hz. acs_stamps_ns: int64 (n,), ns. dso_delay_s: tau_DSO of the\n"
             "trigger output; start_latency_s: from trigger to first sample, taken out.\n"
             "\n"
             "Raises Error as fit_sine does; the sentence names the channel.\n"
             "Source: paper 2.4, eqs. (5) to (9); analysis/method/series_stamping.hpp");
}

} // namespace dyncal::python
