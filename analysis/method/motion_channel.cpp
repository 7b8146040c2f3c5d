#include "analysis/method/motion_channel.hpp"

#include "analysis/sine/disturbances.hpp"

namespace dyncal::analysis {
namespace {

tl::unexpected<Error> of_channel(const ChannelSamples& channel, Error error) {
  error.message = channel.name + ": " + error.message;
  return fail(std::move(error));
}

} // namespace

bool is_differentiated(const ChannelSamples& channel) {
  return channel.motion && channel.motion->measured != MotionQuantity::acceleration;
}

Expected<void> take_motion(std::span<const double> values, RecordedChannel& channel) {
  ChannelFit& result = channel.result;
  auto motion =
      motion_of_step(channel.samples.motion->measured, result.frequency, channel.stamps_ns, values);
  if (!motion) {
    return of_channel(channel.samples, motion.error());
  }
  const std::span<const double> fitted[] = {motion->values};
  auto fits = fit_sine_beside_disturbances(result.frequency, result.phase_origin_ns,
                                           motion->stamps_ns, fitted, channel.samples.mains_hz);
  if (!fits) {
    return of_channel(channel.samples, fits.error());
  }
  CleanedFit& fit = fits->front();
  const double offset = result.fit.offset;
  result.fit = fit.fit;
  result.fit.offset = offset;
  channel.samples.values = values;
  channel.drift_order = 0;
  channel.noise_factor = motion->noise_factor;
  channel.motion_stamps_ns = std::move(motion->stamps_ns);
  channel.cleaned = fit.values.empty() ? std::move(motion->values) : std::move(fit.values);
  return {};
}

Expected<MotionFrequency> frequency_of_motion(const Frequency& nominal, double frequency_search_rel,
                                              std::span<const std::int64_t> stamps_ns,
                                              const ChannelSamples& channel) {
  const auto motion = motion_of_step(channel.motion->measured, nominal, stamps_ns, channel.values);
  if (!motion) {
    return of_channel(channel, motion.error());
  }
  const std::span<const double> values[] = {motion->values};
  const std::int64_t middle_ns = stamps_ns.front() + (stamps_ns.back() - stamps_ns.front()) / 2;
  const auto found = fit_frequency_beside_disturbances(nominal, frequency_search_rel, middle_ns,
                                                       motion->stamps_ns, values, channel.mains_hz);
  if (!found) {
    return of_channel(channel, found.error());
  }
  return MotionFrequency{found->frequency, found->u_frequency_hz};
}

} // namespace dyncal::analysis
