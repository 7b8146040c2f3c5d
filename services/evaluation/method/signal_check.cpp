#include "services/evaluation/method/signal_check.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "analysis/step/signal_integrity.hpp"
#include "analysis/uncertainty/found_resolution.hpp"

namespace dyncal::services {
namespace {

// The resolution is found in the values where nobody stated it: the extremes of a sine of few steps
// repeat by nature.
analysis::SignalExpectation expectation_of(const drivers::ChannelDescription& description,
                                           std::span<const double> values) {
  analysis::SignalExpectation expected;
  if (description.maximum > description.minimum) {
    expected.range_low = description.minimum;
    expected.range_high = description.maximum;
  }
  expected.resolution =
      description.resolution > 0.0 ? description.resolution : analysis::found_resolution(values);
  return expected;
}

std::string percent(double part) {
  return fmt::format("{:.2g} %", 100.0 * part);
}

Flag of_channel(ResultFlag kind, const std::string& channel, const std::string& how_much) {
  return {kind, fmt::format("{}: {}: {}", channel, to_string(kind), how_much)};
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

SignalCheck check_signal(const analysis::ChannelFit& fit, std::span<const std::int64_t> stamps_ns,
                         std::span<const double> values,
                         const drivers::ChannelDescription& description) {
  const auto integrity = analysis::measure_integrity(fit.frequency, stamps_ns, values,
                                                     expectation_of(description, values));
  SignalCheck check{.signal = {.channel = fit.channel}, .flags = {}, .refusal = {}};
  if (!integrity) {
    if (integrity.error().code != analysis::ErrorCode::no_excitation) {
      check.flags.push_back(
          of_channel(ResultFlag::signal_not_judged, fit.channel, integrity.error().message));
    }
    return check;
  }
  check.signal = signal_of(fit.channel, *integrity);
  const analysis::IntegrityFindings findings = analysis::judge_integrity(*integrity);
  if (findings.over_range) {
    check.flags.push_back(of_channel(
        ResultFlag::over_range, fit.channel,
        percent(std::max(integrity->at_range_part, integrity->clipped_part)) + " of the samples"));
  }
  if (findings.stuck) {
    check.flags.push_back(
        of_channel(ResultFlag::values_stuck, fit.channel,
                   fmt::format("up to {} samples long",
                               std::max(integrity->longest_stuck, integrity->longest_repeat))));
  }
  if (findings.distorted) {
    check.flags.push_back(of_channel(ResultFlag::distorted, fit.channel,
                                     "total harmonic distortion " + percent(integrity->thd)));
  }
  if (findings.refused) {
    check.refusal = refusal_of(fit.channel, *integrity, findings);
  }
  return check;
}

SignalCheck check_signal(const analysis::ChannelFit& fit, const SelectedChannels& selected,
                         std::size_t index) {
  return check_signal(fit, selected.stamps_ns(), selected.channel(index).values,
                      selected.description(index));
}

} // namespace dyncal::services
