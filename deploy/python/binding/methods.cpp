// The paper's ways that link clocks sample by sample: analysis/method/sample_stamping.hpp and
// analogue_comparison.hpp.
#include <optional>
#include <utility>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include "analysis/method/analogue_comparison.hpp"
#include "analysis/method/sample_stamping.hpp"
#include "bindings.hpp"
#include "channels.hpp"
#include "frequency_argument.hpp"

namespace dyncal::python {
namespace {

using namespace nb::literals;
using analysis::ComparisonResult;
using analysis::ComparisonUncertainty;
using analysis::SampleStampingResult;
using analysis::SystematicUncertainty;
using Stamps = Array<std::int64_t>;

constexpr double usual_search_rel = 1e-3;

SampleStampingResult
sample_stamping(const FrequencyArgument& frequency, Stamps& acs_stamps_ns, Channel reference,
                Channel sync_acs, Stamps& dau_stamps_ns, Channel sync_dau, std::vector<Channel> dut,
                std::optional<Stamps> dut_stamps_ns, const analysis::AdcResponse& adc,
                double reference_delay_s, const analysis::ReferenceResponse& reference_response,
                const SystematicUncertainty& systematic, double frequency_search_rel) {
  analysis::SampleStampingInput input{.frequency = frequency.frequency()};
  input.frequency_search_rel = frequency_search_rel;
  input.acs_stamps_ns = acs_stamps_ns.span("acs_stamps_ns");
  input.reference = reference.samples();
  input.sync_acs = sync_acs.samples();
  input.dau_stamps_ns = dau_stamps_ns.span("dau_stamps_ns");
  input.sync_dau = sync_dau.samples();
  input.dut = samples_of(dut);
  if (dut_stamps_ns) {
    input.dut_stamps_ns = dut_stamps_ns->span("dut_stamps_ns");
  }
  input.adc = adc;
  input.reference_delay_s = reference_delay_s;
  input.reference_response = reference_response;
  input.systematic = systematic;
  const nb::gil_scoped_release released;
  return value_of(analysis::evaluate_sample_stamping(input));
}

ComparisonResult analogue(const FrequencyArgument& frequency, Stamps& stamps_ns, Channel reference,
                          std::vector<Channel> dut, std::optional<Channel> sync,
                          double channel_delay_s,
                          const analysis::ReferenceResponse& reference_response,
                          const ComparisonUncertainty& systematic, double frequency_search_rel) {
  analysis::AnalogueInput input{.frequency = frequency.frequency()};
  input.frequency_search_rel = frequency_search_rel;
  input.stamps_ns = stamps_ns.span("stamps_ns");
  input.reference = reference.samples();
  if (sync) {
    input.sync = sync->samples();
  }
  input.dut = samples_of(dut);
  input.channel_delay_s = channel_delay_s;
  input.reference_response = reference_response;
  input.systematic = systematic;
  const nb::gil_scoped_release released;
  return value_of(analysis::evaluate_analogue(input));
}

ComparisonResult absolute_time(const FrequencyArgument& frequency, Stamps& reference_stamps_ns,
                               Channel reference, Stamps& dut_stamps_ns, std::vector<Channel> dut,
                               double channel_delay_s,
                               const analysis::ReferenceResponse& reference_response,
                               const ComparisonUncertainty& systematic,
                               double frequency_search_rel) {
  analysis::AbsoluteTimeInput input{.frequency = frequency.frequency()};
  input.frequency_search_rel = frequency_search_rel;
  input.reference_stamps_ns = reference_stamps_ns.span("reference_stamps_ns");
  input.reference = reference.samples();
  input.dut_stamps_ns = dut_stamps_ns.span("dut_stamps_ns");
  input.dut = samples_of(dut);
  input.channel_delay_s = channel_delay_s;
  input.reference_response = reference_response;
  input.systematic = systematic;
  const nb::gil_scoped_release released;
  return value_of(analysis::evaluate_absolute_time(input));
}

void bind_systematic(nb::module_& module) {
  nb::class_<SystematicUncertainty>(module, "SystematicUncertainty",
                                    "Standard uncertainties that no residual shows.\n"
                                    "Source: analysis/method/sample_stamping.hpp")
      .def(
          "__init__",
          [](SystematicUncertainty* self, double reference_magnitude_rel,
             double reference_phase_rad, double acs_delay_s, double dau_jitter_s, double dau_tick_s,
             double sync_adc_jitter_s, double clock_offset_s, double dut_tick_s) {
            new (self) SystematicUncertainty{
                reference_magnitude_rel, reference_phase_rad, acs_delay_s, dau_jitter_s, dau_tick_s,
                sync_adc_jitter_s,       clock_offset_s,      dut_tick_s};
          },
          nb::kw_only(), "reference_magnitude_rel"_a = 0.0, "reference_phase_rad"_a = 0.0,
          "acs_delay_s"_a = 0.0, "dau_jitter_s"_a = 0.0, "dau_tick_s"_a = 0.0,
          "sync_adc_jitter_s"_a = 0.0, "clock_offset_s"_a = 0.0, "dut_tick_s"_a = 0.0,
          "acs_delay_s: residual delay between the ACS channels; dau_jitter_s: white noise of\n"
          "the stamps; a tick: quantum of stamps, 0: none; sync_adc_jitter_s: of the instant at\n"
          "which the DAU samples sync; clock_offset_s: of a sensor with stamps of its own.");
  nb::class_<ComparisonUncertainty>(module, "ComparisonUncertainty",
                                    "Standard uncertainties that no residual shows.\n"
                                    "Source: analysis/method/analogue_comparison.hpp")
      .def(
          "__init__",
          [](ComparisonUncertainty* self, double reference_magnitude_rel,
             double reference_phase_rad, double channel_delay_s, double clock_offset_s,
             double stamp_jitter_s, double reference_tick_s, double dut_tick_s) {
            new (self) ComparisonUncertainty{
                reference_magnitude_rel, reference_phase_rad, channel_delay_s, clock_offset_s,
                stamp_jitter_s,          reference_tick_s,    dut_tick_s};
          },
          nb::kw_only(), "reference_magnitude_rel"_a = 0.0, "reference_phase_rad"_a = 0.0,
          "channel_delay_s"_a = 0.0, "clock_offset_s"_a = 0.0, "stamp_jitter_s"_a = 0.0,
          "reference_tick_s"_a = 0.0, "dut_tick_s"_a = 0.0,
          "channel_delay_s: of that correction; the last four for absolute time.");
}

void bind_results(nb::module_& module) {
  nb::class_<SampleStampingResult>(
      module, "SampleStampingResult",
      "The sines of the reference and of both syncs, and the values of the DUT's channels.\n"
      "Source: analysis/method/sample_stamping.hpp")
      .def_ro("reference", &SampleStampingResult::reference)
      .def_ro("sync_acs", &SampleStampingResult::sync_acs)
      .def_ro("sync_dau", &SampleStampingResult::sync_dau)
      .def_ro("points", &SampleStampingResult::points, "a TransferPoint each of `dut`")
      .def_ro("findings", &SampleStampingResult::findings);
  nb::class_<ComparisonResult>(
      module, "ComparisonResult",
      "The sines of reference and sync, and the values of the DUT's channels.\n"
      "Source: analysis/method/analogue_comparison.hpp")
      .def_ro("reference", &ComparisonResult::reference)
      .def_ro("sync", &ComparisonResult::sync, "None: there was none")
      .def_ro("points", &ComparisonResult::points, "a TransferPoint each of `dut`")
      .def_ro("findings", &ComparisonResult::findings);
}

} // namespace

void bind_methods(nb::module_& module) {
  bind_systematic(module);
  bind_results(module);
  const auto response = "reference_response"_a = analysis::ReferenceResponse{};
  const auto search = "frequency_search_rel"_a = usual_search_rel;
  module.def(
      "evaluate_sample_stamping", &sample_stamping, "frequency"_a, nb::kw_only(), "acs_stamps_ns"_a,
      "reference"_a, "sync_acs"_a, "dau_stamps_ns"_a, "sync_dau"_a, "dut"_a,
      "dut_stamps_ns"_a = nb::none(), "adc"_a = analysis::AdcResponse{},
      "reference_delay_s"_a = 0.0, response, "systematic"_a = SystematicUncertainty{}, search,
      "Sample time stamping: H of sensors from the four channels of one excitation step.\n"
      "\n"
      "frequency: nominal, Hz; refined on sync in each clock within frequency_search_rel (0:\n"
      "known exactly). Stamps: int64 (n,), ns, of ACS, DAU and, if it has its own, the sensor.\n"
      "reference_delay_s: known delay of the reference's channel against sync, taken out.\n"
      "\n"
      "Raises Error as fit_sine does; the sentence names the channel.\n"
      "Source: paper eqs. (3), (4); analysis/method/sample_stamping.hpp");
  module.def("evaluate_analogue", &analogue, "frequency"_a, nb::kw_only(), "stamps_ns"_a,
             "reference"_a, "dut"_a, "sync"_a = nb::none(), "channel_delay_s"_a = 0.0, response,
             "systematic"_a = ComparisonUncertainty{}, search,
             "H of sensors that are channels of the reference's own clock.\n"
             "\n"
             "channel_delay_s: known extra delay of the sensor's channel. Shapes, units and\n"
             "errors as evaluate_sample_stamping. Source: paper eqs. (1), (2);\n"
             "analysis/method/analogue_comparison.hpp");
  module.def("evaluate_absolute_time", &absolute_time, "frequency"_a, nb::kw_only(),
             "reference_stamps_ns"_a, "reference"_a, "dut_stamps_ns"_a, "dut"_a,
             "channel_delay_s"_a = 0.0, response, "systematic"_a = ComparisonUncertainty{}, search,
             "H of sensors whose clock and that of the reference both follow UTC.\n"
             "\n"
             "Shapes, units and errors as evaluate_sample_stamping.\n"
             "Source: analysis/method/analogue_comparison.hpp");
}

} // namespace dyncal::python
