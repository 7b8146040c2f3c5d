#include "services/evaluation/line_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/evaluation/method/line_check.hpp"

namespace dyncal::services {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;
using analysis::LineKind;

constexpr int first_high_order = 6; // harmonics from here on count as one

bool is_of_line(const Flag& flag) {
  return flag.kind == ResultFlag::mains_not_separated ||
         flag.kind == ResultFlag::harmonic_not_separated;
}

void add_row(ContributionKind kind, const ChannelLines& channel, double u2, StepResult& result) {
  if (!(u2 > 0.0)) {
    return;
  }
  const double u = std::sqrt(u2);
  result.budget.push_back({.kind = kind,
                           .subject = channel.subject,
                           .distribution = analysis::Distribution::arcsine,
                           .u_magnitude_rel = channel.counts_in_magnitude ? u : 0.0,
                           .u_phase_rad = u});
  if (channel.counts_in_magnitude) {
    result.u_magnitude = std::hypot(result.u_magnitude, u * result.magnitude);
  }
  result.u_phase_rad = std::hypot(result.u_phase_rad, u);
}

} // namespace

bool LineBounds::is_new(const StepOfChannel& where, std::uint32_t attempt) {
  const auto [known, inserted] = known_.emplace(where, attempt);
  if (inserted) {
    return true;
  }
  if (attempt <= known->second) {
    return false;
  }
  known->second = attempt;
  for (auto& [line, measured] : measured_) {
    std::erase_if(measured, [&](const Measured& one) { return one.where == where; });
  }
  return true;
}

void LineBounds::add(const StepResult& result) {
  for (const ChannelLines& channel : result.lines) {
    const StepOfChannel where{channel.channel, result.step, result.repetition};
    if (!is_new(where, result.attempt)) {
      continue;
    }
    for (const MeasuredLine& line : channel.measured) {
      measured_[{channel.channel, line.kind, line.line_hz, std::min(line.order, first_high_order)}]
          .push_back({where, line.measured});
    }
  }
}

std::optional<double> LineBounds::square_of(const ChannelLines& channel,
                                            const analysis::UnresolvedLine& line) const {
  const bool mains = line.kind == LineKind::mains;
  const auto found = measured_.find({channel.channel, line.kind, mains ? line.line_hz : 0.0,
                                     mains ? 0 : std::min(line.order, first_high_order)});
  if (found == measured_.end() || found->second.empty()) {
    return std::nullopt;
  }
  std::vector<analysis::MeasuredAmplitude> amplitudes;
  std::transform(found->second.begin(), found->second.end(), std::back_inserter(amplitudes),
                 [](const Measured& one) { return one.amplitude; });
  return analysis::square_of_amplitude(amplitudes);
}

void LineBounds::settle(const ChannelLines& channel, StepResult& result) const {
  double of_mains = 0.0, of_harmonics = 0.0;
  for (const analysis::UnresolvedLine& line : channel.unresolved) {
    const auto square = square_of(channel, line);
    if (!square) {
      result.flags.push_back(flag_of_line(channel.channel, line));
      continue;
    }
    const bool mains = line.kind == LineKind::mains;
    const double u = analysis::line_uncertainty(line, std::sqrt(*square),
                                                mains ? channel.amplitude : 1.0, channel.duration_s)
                         .u_phase_rad;
    (mains ? of_mains : of_harmonics) += u * u;
  }
  add_row(ContributionKind::mains_hum, channel, of_mains, result);
  add_row(ContributionKind::folded_harmonic, channel, of_harmonics, result);
}

StepResult LineBounds::settled(StepResult result) const {
  result.flags.erase(std::remove_if(result.flags.begin(), result.flags.end(), is_of_line),
                     result.flags.end());
  for (const ChannelLines& channel : result.lines) {
    settle(channel, result);
  }
  result.provisional = false;
  return result;
}

} // namespace dyncal::services
