#include "analysis/method/analogue_comparison.hpp"

#include <cmath>

#include "analysis/base/phasor.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/own_clock_channel.hpp"
#include "analysis/uncertainty/ratio_scatter.hpp"

namespace dyncal::analysis {
namespace {

Budget systematic_rows(const RecordedChannel& reference, double w,
                       const ReferenceResponse& response, const ComparisonUncertainty& systematic) {
  Budget budget;
  add_signal_rows(budget, "the reference", reference, 0.0, CountsIn::magnitude_and_phase);
  budget.add({.kind = ContributionKind::channel_delay,
              .subject = "the channels",
              .u_phase_rad = w * systematic.channel_delay_s});
  add_reference_rows(budget, response, systematic.reference_magnitude_rel,
                     systematic.reference_phase_rad);
  return budget;
}

} // namespace

Expected<ComparisonResult> evaluate_analogue(const AnalogueInput& input) {
  const auto system = fit_channels_of_one_clock(input.frequency, input.frequency_search_rel,
                                                input.stamps_ns, input.reference, input.dut);
  if (!system) {
    return fail(system.error());
  }
  const RecordedChannel& reference = system->pilot;
  const double w = reference.result.frequency.angular();
  const std::complex<double> link = std::polar(1.0, w * input.channel_delay_s) /
                                    reference.phasor() * input.reference_response.phasor();
  const Budget common = systematic_rows(reference, w, input.reference_response, input.systematic);
  ComparisonResult result{reference.result, {}};
  for (const RecordedChannel& dut : system->others) {
    Budget budget;
    add_sensor_rows(budget, dut, 0.0);
    budget.append(common);
    budget.add_excess("the signals",
                      ratio_scatter(reference.result.frequency, input.stamps_ns, dut.values(),
                                    reference.values()),
                      budget.u_magnitude_rel(), budget.u_phase_rad());
    result.points.push_back(transfer_point(dut, link, budget));
  }
  return result;
}

Expected<ComparisonResult> evaluate_absolute_time(const AbsoluteTimeInput& input) {
  const auto acs = fit_channels_of_one_clock(input.frequency, input.frequency_search_rel,
                                             input.reference_stamps_ns, input.reference, {});
  if (!acs) {
    return fail(acs.error());
  }
  const RecordedChannel& reference = acs->pilot;
  ComparisonResult result{reference.result, {}};
  const double w = reference.result.frequency.angular();
  const Budget common = systematic_rows(reference, w, input.reference_response, input.systematic);
  const std::complex<double> link = std::polar(1.0, w * input.channel_delay_s) /
                                    reference.phasor() * input.reference_response.phasor();
  const OwnClockUncertainty clock{.clock_offset_s = input.systematic.clock_offset_s,
                                  .stamp_jitter_s = input.systematic.stamp_jitter_s};
  for (const ChannelSamples& channel : input.dut) {
    auto point = evaluate_own_clock_channel(reference.result, link, common, input.dut_stamps_ns,
                                            channel, clock);
    if (!point) {
      return fail(point.error());
    }
    result.points.push_back(std::move(*point));
  }
  return result;
}

} // namespace dyncal::analysis
