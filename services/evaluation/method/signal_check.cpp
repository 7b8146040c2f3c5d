#include "services/evaluation/method/signal_check.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "analysis/step/signal_integrity.hpp"

namespace dyncal::inline evaluation {
namespace {

std::string percent(double part) {
  return fmt::format("{:.2g} %", 100.0 * part);
}

ChannelSignal signal_of(const std::string& channel, const analysis::SignalIntegrity& integrity) {
  return {.channel = channel,
          .thd = integrity.thd,
          .u_thd = integrity.u_thd,
          .residual = integrity.residual_sd / integrity.amplitude,
          .over_noise = integrity.noise_sd > 0.0 ? integrity.residual_sd / integrity.noise_sd
                                                 : ChannelSignal::not_known};
}

std::string refusal_of(const std::string& channel, const analysis::SignalIntegrity& integrity,
                       const analysis::IntegrityFindings& findings) {
  if (findings.over_range) {
    return fmt::format("{} is over its range: {} of its samples are at an end of it; lower the "
                       "level, or choose a wider range",
                       channel, percent(std::max(integrity.at_range_part, integrity.clipped_part)));
  }
  return fmt::format("{} repeats the same value while the signal moves, up to {} samples long; "
                     "check the sensor and its interface",
                     channel, integrity.longest_stuck);
}

} // namespace

SignalCheck check_signal(const std::string& channel,
                         const analysis::Expected<analysis::SignalIntegrity>& integrity) {
  SignalCheck check{.signal = {.channel = channel}, .flags = {}, .refusal = {}};
  if (!integrity) {
    if (integrity.error().code != analysis::ErrorCode::no_excitation) {
      check.flags.push_back(
          flag_of_channel(ResultFlag::signal_not_judged, channel, integrity.error().message));
    }
    return check;
  }
  check.signal = signal_of(channel, *integrity);
  if (integrity->beyond_range) {
    check.flags.push_back(
        flag_of_channel(ResultFlag::signal_not_judged, channel,
                        "its values lie beyond the range that is stated for it, which "
                        "therefore cannot be its range; state it, or none, with the "
                        "key 'ranges'"));
  }
  const analysis::IntegrityFindings findings = analysis::judge_integrity(*integrity);
  if (findings.over_range) {
    check.flags.push_back(flag_of_channel(
        ResultFlag::over_range, channel,
        percent(std::max(integrity->at_range_part, integrity->clipped_part)) + " of the samples"));
  }
  if (findings.stuck) {
    check.flags.push_back(
        flag_of_channel(ResultFlag::values_stuck, channel,
                        fmt::format("up to {} samples long", std::max(integrity->longest_stuck,
                                                                      integrity->longest_repeat))));
  }
  if (findings.distorted) {
    check.flags.push_back(flag_of_channel(ResultFlag::distorted, channel,
                                          "total harmonic distortion " + percent(integrity->thd)));
  }
  if (findings.refused) {
    check.refusal = refusal_of(channel, *integrity, findings);
  }
  return check;
}

SignalCheck check_signal(const analysis::ChannelFit& fit) {
  return fit.integrity
             ? check_signal(fit.channel, *fit.integrity)
             : SignalCheck{.signal = {.channel = fit.channel}, .flags = {}, .refusal = {}};
}

analysis::SignalExpectation expectation_of(const drivers::ChannelDescription& description) {
  analysis::SignalExpectation expected;
  if (description.maximum > description.minimum) {
    expected.range_low = description.minimum;
    expected.range_high = description.maximum;
  }
  expected.resolution = std::max(0.0, description.resolution);
  return expected;
}

} // namespace dyncal::inline evaluation
