// What goes into an evaluation and what comes out of it: analysis/method/transfer_point.hpp.
#include "channels.hpp"

#include <nanobind/stl/complex.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/method/step_findings.hpp"
#include "bindings.hpp"

namespace dyncal::python {
namespace {

using namespace nb::literals;
using analysis::ChannelFit;
using analysis::PointFindings;
using analysis::SignalIntegrity;
using analysis::StepFindings;
using analysis::TransferPoint;

constexpr double infinity = std::numeric_limits<double>::infinity();

void bind_channel(nb::module_& module) {
  nb::class_<Channel>(module, "Channel",
                      "A recorded channel of a step.\n"
                      "\n"
                      "values: float64 (n,), contiguous, kept without a copy: do not change it\n"
                      "before it was evaluated. resolution: one quantisation step, 0: not stated.\n"
                      "minimum, maximum: range, in the unit of the values. mains_hz: lines that\n"
                      "are looked for beside the sine. Source: analysis/method/transfer_point.hpp")
      .def(
          "__init__",
          [](Channel* self, const std::string& name, const Array<double>& values, double resolution,
             double minimum, double maximum, const std::vector<double>& mains_hz) {
            Channel channel{name, values, resolution, minimum, maximum, mains_hz};
            static_cast<void>(channel.samples()); // refuses what is no array
            new (self) Channel(std::move(channel));
          },
          "name"_a, "values"_a, nb::kw_only(), "resolution"_a = 0.0, "minimum"_a = -infinity,
          "maximum"_a = infinity,
          "mains_hz"_a =
              std::vector<double>(analysis::usual_mains_hz.begin(), analysis::usual_mains_hz.end()))
      .def_ro("name", &Channel::name)
      .def_ro("values", &Channel::values)
      .def_ro("resolution", &Channel::resolution)
      .def_ro("minimum", &Channel::minimum)
      .def_ro("maximum", &Channel::maximum)
      .def_ro("mains_hz", &Channel::mains_hz);
}

void bind_integrity(nb::module_& module) {
  nb::class_<SignalIntegrity>(module, "SignalIntegrity",
                              "Whether a channel's series is what its sensor felt, as numbers.\n"
                              "Source: analysis/step/signal_integrity.hpp")
      .def_ro("samples", &SignalIntegrity::samples)
      .def_ro("amplitude", &SignalIntegrity::amplitude)
      .def_ro("at_range_part", &SignalIntegrity::at_range_part, "of all samples")
      .def_ro("beyond_range", &SignalIntegrity::beyond_range)
      .def_ro("clipped_part", &SignalIntegrity::clipped_part, "of all samples")
      .def_ro("clipping_rel", &SignalIntegrity::clipping_rel, "taken off the amplitude, about")
      .def_ro("longest_stuck", &SignalIntegrity::longest_stuck, "samples")
      .def_ro("thd", &SignalIntegrity::thd, "harmonics over the sine")
      .def_ro("u_thd", &SignalIntegrity::u_thd, "what noise alone gives")
      .def_ro("residual_sd", &SignalIntegrity::residual_sd)
      .def_ro("noise_sd", &SignalIntegrity::noise_sd, "of neighbouring residuals");
}

void bind_findings(nb::module_& module) {
  using analysis::KnockedChannel;
  using analysis::RatioChange;
  nb::class_<RatioChange>(
      module, "RatioChange",
      "The ratio is another one from at_s on. Source: analysis/uncertainty/ratio_change.hpp")
      .def_ro("at_s", &RatioChange::at_s)
      .def_ro("magnitude_rel", &RatioChange::magnitude_rel)
      .def_ro("phase_rad", &RatioChange::phase_rad);
  nb::class_<PointFindings>(
      module, "PointFindings",
      "What was found along one point of a step. Source: analysis/method/step_findings.hpp")
      .def_ro("change", &PointFindings::change, "of the ratio within the step; None: none")
      .def_ro("too_short_for_noise", &PointFindings::too_short_for_noise);
  nb::class_<KnockedChannel>(module, "KnockedChannel",
                             "A knock, to be cut out. Source: analysis/method/step_findings.hpp")
      .def_ro("channel", &KnockedChannel::channel)
      .def_prop_ro("first_ns", [](const KnockedChannel& one) { return one.knock.first_ns; })
      .def_prop_ro("last_ns", [](const KnockedChannel& one) { return one.knock.last_ns; });
  nb::class_<StepFindings>(module, "StepFindings",
                           "What was found along the record; say it with the values.\n"
                           "Source: analysis/method/step_findings.hpp")
      .def_ro("points", &StepFindings::points, "in the order of the points")
      .def_ro("knocks", &StepFindings::knocks);
}

} // namespace

void bind_channels(nb::module_& module) {
  bind_channel(module);
  bind_integrity(module);
  bind_findings(module);
  nb::class_<ChannelFit>(
      module, "ChannelFit",
      "The sine fitted to one recorded channel. Source: analysis/method/transfer_point.hpp")
      .def_ro("channel", &ChannelFit::channel)
      .def_ro("frequency", &ChannelFit::frequency, "in the clock of its stamps")
      .def_ro("u_frequency_hz", &ChannelFit::u_frequency_hz, "Hz")
      .def_ro("phase_origin_ns", &ChannelFit::phase_origin_ns, "ns")
      .def_ro("fit", &ChannelFit::fit)
      .def_ro("integrity", &ChannelFit::integrity, "None: without excitation");
  nb::class_<TransferPoint>(module, "TransferPoint",
                            "One value of the complex transfer function, H = |H| e^(i psi): psi\n"
                            "is lead in rad, a delay is negative. u: standard uncertainties.\n"
                            "Source: analysis/method/transfer_point.hpp")
      .def_ro("channel", &TransferPoint::channel)
      .def_ro("h", &TransferPoint::h, "complex, unit of the sensor over that of the reference")
      .def_ro("magnitude", &TransferPoint::magnitude, "|H|")
      .def_ro("u_magnitude", &TransferPoint::u_magnitude)
      .def_ro("phase_rad", &TransferPoint::phase_rad, "(-pi, pi]")
      .def_ro("u_phase_rad", &TransferPoint::u_phase_rad)
      .def_ro("budget", &TransferPoint::budget, "rows of Contribution")
      .def_ro("dut", &TransferPoint::dut);
}

} // namespace dyncal::python
