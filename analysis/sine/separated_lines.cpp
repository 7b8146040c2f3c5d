#include "analysis/sine/separated_lines.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr int drift_order = 2;
constexpr double max_widening = 1.1;
constexpr double max_widening_of_clocks = 3.0;
constexpr std::size_t values_at_once = 4096;

std::int64_t middle_ns(std::span<const std::int64_t> stamps_ns) {
  return stamps_ns.front() + (stamps_ns.back() - stamps_ns.front()) / 2;
}

// In the order of the lines, of which number `first` was fitted as the fundamental.
std::vector<LinePhasor> phasors_of(const ExtendedFit& fit, std::size_t first) {
  std::vector<LinePhasor> lines;
  for (const FurtherPhasor& one : fit.lines) {
    lines.push_back({{one.sine, one.cosine}, std::max(one.u_sine, one.u_cosine)});
  }
  const SineFit& of_first = fit.fundamental;
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(first),
               {{of_first.sine, of_first.cosine},
                std::sqrt(std::max(of_first.covariance[0], of_first.covariance[3]))});
  return lines;
}

struct JointFit {
  std::vector<ExtendedFit> channels;
  std::size_t first = 0;
};

// By the first line that some channel shows: one that is lost in noise is no fundamental.
Expected<JointFit> fit_jointly(std::span<const Frequency> lines, std::int64_t origin_ns,
                               std::span<const std::int64_t> stamps_ns,
                               std::span<const std::span<const double>> channels) {
  for (std::size_t first = 0;; ++first) {
    ExtendedBasis basis{.drift_order = drift_order, .lines = {lines.begin(), lines.end()}};
    basis.lines.erase(basis.lines.begin() + static_cast<std::ptrdiff_t>(first));
    auto fits =
        fit_sine_extended(lines[first], basis, Weighting::none, origin_ns, stamps_ns, channels);
    if (fits) {
      return JointFit{std::move(*fits), first};
    }
    if (fits.error().code != ErrorCode::no_excitation || first + 1 == lines.size()) {
      return fail(std::move(fits.error()));
    }
  }
}

Expected<void> check_widening(std::span<const Frequency> frequencies, const ExtendedFit& fit,
                              const std::vector<LinePhasor>& lines, LinesMayOverlap overlap) {
  const double most = overlap == LinesMayOverlap::hardly ? max_widening : max_widening_of_clocks;
  const double alone =
      fit.fundamental.residual_sd() * std::sqrt(2.0 / static_cast<double>(fit.fundamental.samples));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].u_component > most * alone) {
      return fail(ErrorCode::ill_conditioned,
                  "the lines near " + std::to_string(frequencies[i].hz()) +
                      " Hz cannot be told apart in this record; record longer");
    }
  }
  return {};
}

} // namespace

SeparatedLines::SeparatedLines(std::span<const Frequency> lines,
                               std::span<const std::int64_t> stamps_ns)
    : frequencies_(lines.begin(), lines.end()), stamps_ns_(stamps_ns),
      origin_ns_(stamps_ns.empty() ? 0 : middle_ns(stamps_ns)) {}

Expected<SeparatedLines> SeparatedLines::make(std::span<const Frequency> lines,
                                              std::span<const std::int64_t> stamps_ns,
                                              std::span<const std::span<const double>> channels,
                                              LinesMayOverlap overlap) {
  SeparatedLines separated(lines, stamps_ns);
  DYNCAL_TRY(const auto joint, fit_jointly(lines, separated.origin_ns_, stamps_ns, channels));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Channel& channel = separated.channels_.emplace_back();
    channel.lines = phasors_of(joint.channels[c], joint.first);
    channel.residual_sd = joint.channels[c].fundamental.residual_sd();
    DYNCAL_TRY(check_widening(lines, joint.channels[c], channel.lines, overlap));
    channel.rest.assign(channels[c].begin(), channels[c].end());
    for (std::size_t line = 0; line < lines.size(); ++line) {
      separated.add_line(line, -channel.lines[line].phasor, channel.rest);
    }
  }
  return separated;
}

void SeparatedLines::add_line(std::size_t line, std::complex<double> phasor,
                              std::span<double> values) const {
  double sine[values_at_once];
  double cosine[values_at_once];
  for (std::size_t first = 0; first < values.size(); first += values_at_once) {
    const std::size_t n = std::min(values_at_once, values.size() - first);
    fill_sine_cosine(frequencies_[line], origin_ns_, stamps_ns_.subspan(first, n), sine, cosine);
    for (std::size_t i = 0; i < n; ++i) {
      values[first + i] += phasor.real() * sine[i] + phasor.imag() * cosine[i];
    }
  }
}

std::vector<double> SeparatedLines::only(std::size_t line, std::size_t channel) const {
  std::vector<double> values = channels_[channel].rest;
  add_line(line, channels_[channel].lines[line].phasor, values);
  return values;
}

} // namespace dyncal::analysis
