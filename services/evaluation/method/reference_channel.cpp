#include "services/evaluation/method/reference_channel.hpp"

#include <algorithm>
#include <memory>

#include <fmt/core.h>

#include "analysis/interferometer/reference_motion.hpp"
#include "services/contract/excitation_quantity.hpp"

namespace dyncal::inline evaluation {
namespace {

using analysis::MotionQuantity;
using drivers::QuadratureSignals;

template <std::size_t orders>
bool take(const std::vector<double>& from, std::array<double, orders>& to) {
  if (from.size() != orders) {
    return false;
  }
  std::ranges::copy(from, to.begin());
  return true;
}

analysis::Expected<analysis::InterferometerErrors> errors_of(const QuadratureSignals& signals) {
  analysis::InterferometerErrors errors;
  errors.displacement_per_turn_m = signals.displacement_per_turn_m;
  errors.u_wavelength_rel = signals.u_wavelength_rel;
  errors.detectors.u_skew_s = signals.u_skew_s;
  if (signals.detector_bandwidth_hz > 0.0) {
    errors.detectors.bandwidth_hz = signals.detector_bandwidth_hz;
  }
  if (!(signals.radius_u1 > 0.0) || !take(signals.u_ellipse_rad, errors.ellipse_rad)) {
    return fail(analysis::ErrorCode::ill_conditioned,
                fmt::format("{}: its interferometer has not found the ellipse of its signals yet; "
                            "drive at a low frequency before, or state one",
                            signals.channel));
  }
  if (!take(signals.periodic_error_rad, errors.periodic_rad)) {
    return fail(
        analysis::ErrorCode::ill_conditioned,
        fmt::format("{}: its interferometer has not seen a whole turn of phase yet, and so "
                    "does not know its residual periodic error; drive at a low frequency "
                    "before, let the table drift by half a wavelength, or state the ellipse "
                    "with its periodic_error_rad",
                    signals.channel));
  }
  return errors;
}

} // namespace

analysis::Expected<analysis::ChannelSamples> reference_channel(const SelectedChannels& selected) {
  analysis::ChannelSamples channel = selected.channel(0);
  const QuadratureSignals* signals =
      quadrature_signals_of(selected.record().description(), selected.description(0).name);
  if (signals != nullptr) {
    DYNCAL_TRY(auto errors, errors_of(*signals));
    channel.motion = analysis::ReferenceQuantity{MotionQuantity::displacement,
                                                 MotionQuantity::acceleration, std::move(errors)};
    channel.rise = {}; // the drift before the step is no part of its sine
  }
  return channel;
}

bool is_differentiated(const SelectedChannels& selected) {
  return quadrature_signals_of(selected.record().description(), selected.description(0).name) !=
         nullptr;
}

std::string excitation_unit(const SelectedChannels& selected) {
  return contract::excitation_unit(selected.record().description(), selected.description(0).name);
}

StepSamples settling_samples(const SelectedChannels& selected, double frequency_hz) {
  StepSamples samples = selected.samples();
  if (is_differentiated(selected)) {
    const auto copies = std::make_shared<StepSamples::Copies>();
    copies->columns.push_back(
        analysis::without_slow_motion(frequency_hz, samples.stamps_ns, samples.columns.front()));
    samples.columns.front() = copies->columns.front();
    samples.copies = copies;
  }
  return samples;
}

analysis::ChannelFit excitation_fit(const SelectedChannels& selected, analysis::ChannelFit fit) {
  if (!is_differentiated(selected)) {
    return fit;
  }
  const double factor =
      analysis::motion_factor(MotionQuantity::displacement, MotionQuantity::acceleration,
                              fit.frequency.angular())
          .real();
  analysis::SineFit& sine = fit.fit;
  sine.sine *= factor;
  sine.cosine *= factor;
  sine.offset = 0.0;
  sine.rss *= factor * factor;
  for (double& covariance : sine.covariance) {
    covariance *= factor * factor;
  }
  sine.covariance[2] = sine.covariance[4] = 0.0; // of the offset, which has gone
  return fit;
}

} // namespace dyncal::inline evaluation
