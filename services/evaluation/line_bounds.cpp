#include "services/evaluation/line_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/statistics.hpp"
#include "analysis/uncertainty/background_power.hpp"
#include "services/evaluation/method/line_check.hpp"

namespace dyncal::inline evaluation {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;
using analysis::LineKind;
using analysis::Repeats;

constexpr int first_high_order = 6; // harmonics from here on count as one
constexpr double like_quiet = 0.5;  // of the square: driven steps show no more than quiet time does

bool is_of_line(const Flag& flag) {
  return flag.kind == ResultFlag::mains_not_separated ||
         flag.kind == ResultFlag::harmonic_not_separated;
}

bool is_of_mains(const analysis::UnresolvedLine& line) {
  return line.kind == LineKind::mains;
}

// Square without what noise adds to it.
double square_of(const analysis::MeasuredAmplitude& line) {
  return std::max(0.0, line.amplitude * line.amplitude - 2.0 * line.u_component * line.u_component);
}

// Squares of u, relative and rad.
struct Variances {
  double magnitude = 0.0;
  double phase = 0.0;

  friend Variances operator*(double factor, const Variances& one) {
    return {factor * one.magnitude, factor * one.phase};
  }
};

Variances alike(const ChannelLines& channel, double u2) {
  return {channel.counts_in_magnitude ? u2 : 0.0, u2};
}

void add_row(Contribution row, const Variances& u2, StepResult& result) {
  if (!(u2.phase > 0.0 || u2.magnitude > 0.0)) {
    return;
  }
  row.distribution = analysis::Distribution::arcsine;
  row.u_magnitude_rel = std::sqrt(u2.magnitude);
  row.u_phase_rad = std::sqrt(u2.phase);
  result.u_magnitude = std::hypot(result.u_magnitude, row.u_magnitude_rel * result.magnitude);
  result.u_phase_rad = std::hypot(result.u_phase_rad, row.u_phase_rad);
  result.budget.push_back(std::move(row));
}

// Half of it may come again in every repetition.
void add_half_repeating(Contribution row, const Variances& u2, StepResult& result) {
  for (const Repeats repeats : {Repeats::anew, Repeats::common}) {
    row.repeats = repeats;
    add_row(row, 0.5 * u2, result);
  }
}

// What the scatter along the record shows beyond white noise: u of the result holds it already.
Variances scatter_of(const StepResult& result) {
  Variances largest;
  for (const Contribution& row : result.budget) {
    if (row.kind == ContributionKind::structure && row.repeats == Repeats::anew) {
      largest.magnitude = std::max(largest.magnitude, row.u_magnitude_rel * row.u_magnitude_rel);
      largest.phase = std::max(largest.phase, row.u_phase_rad * row.u_phase_rad);
    }
  }
  return largest;
}

// u of either component that a result holds of noise at its frequency; 0 where it is of shots,
// which noise of one record says nothing of.
double noise_held(const StepResult& result) {
  double square = 0.0;
  for (const Contribution& row : result.budget) {
    if (row.kind == ContributionKind::shots) {
      return 0.0;
    }
    if (row.kind == ContributionKind::fit_noise) {
      square += row.u_phase_rad * row.u_phase_rad;
    }
  }
  const Variances scatter = scatter_of(result);
  return std::sqrt(square + std::min(scatter.magnitude, scatter.phase));
}

// How much of it is beyond what is held.
double share_beyond(double held, double all) {
  return all > 0.0 ? std::max(0.0, 1.0 - held / all) : 0.0;
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
  for (MeasuredLines* lines : {&driven_, &quiet_}) {
    for (auto& [line, measured] : *lines) {
      std::erase_if(measured, [&](const Measured& one) { return one.where == where; });
    }
  }
  return true;
}

void LineBounds::add(const StepResult& result) {
  for (const ChannelLines& channel : result.lines) {
    const StepOfChannel where{channel.channel, result.step, result.repetition};
    if (!is_new(where, result.attempt)) {
      continue;
    }
    const auto take = [&](const std::vector<MeasuredLine>& lines, MeasuredLines& all) {
      for (const MeasuredLine& line : lines) {
        all[{channel.channel, line.kind, line.line_hz, std::min(line.order, first_high_order)}]
            .push_back({where, line.measured, channel.amplitude, channel.duration_s});
      }
    };
    take(channel.measured, driven_);
    take(channel.in_quiet, quiet_);
  }
}

const std::vector<LineBounds::Measured>& LineBounds::driven(const Line& line) const {
  static const std::vector<Measured> none;
  const auto found = driven_.find(line);
  return found == driven_.end() ? none : found->second;
}

const std::vector<LineBounds::Measured>& LineBounds::in_quiet(const Line& line) const {
  static const std::vector<Measured> none;
  const auto found = quiet_.find(line);
  return found == quiet_.end() ? none : found->second;
}

// How much of the square that the quiet time before other steps shows is there when they are
// driven; empty where no step shows both.
std::optional<double> LineBounds::driven_to_quiet(const Line& line,
                                                  const StepOfChannel& where) const {
  if (in_quiet(line).empty()) {
    return std::nullopt;
  }
  std::map<StepOfChannel, double> squares;
  for (const Measured& one : driven(line)) {
    squares.emplace(one.where, square_of(one.line));
  }
  std::vector<double> ratios;
  for (const Measured& quiet : in_quiet(line)) {
    const auto same = squares.find(quiet.where);
    if (quiet.where != where && same != squares.end() && square_of(quiet.line) > 0.0) {
      ratios.push_back(same->second / square_of(quiet.line));
    }
  }
  return ratios.empty() ? std::nullopt : std::optional(analysis::median(std::move(ratios)));
}

LineBounds::Bound LineBounds::bound_of(const Line& line, const StepOfChannel& where,
                                       double excitation, const HeldNoise& held) const {
  std::vector<analysis::MeasuredBackground> measured;
  double u_held = held.u;
  for (const Measured& one : driven(line)) {
    measured.push_back({one.line, one.excitation});
    if (one.duration_s > 0.0) { // what is white is larger in shorter records
      u_held = std::max(u_held, held.u * std::sqrt(held.duration_s / one.duration_s));
    }
  }
  const auto ratio = driven_to_quiet(line, where);
  const bool constant = ratio && *ratio > like_quiet && *ratio < 1.0 / like_quiet;
  const auto power = analysis::significant_background(measured, excitation, constant, u_held);
  Bound bound{power.value_or(0.0), !measured.empty(), power.has_value()};
  for (const Measured& quiet : in_quiet(line)) {
    if (quiet.where == where) {
      const double square = std::min(1.0, ratio.value_or(1.0)) * square_of(quiet.line);
      bound.significant |= square > 0.0;
      bound.square = std::max(bound.square, square);
    }
  }
  if (!power && (bound.significant || std::get<analysis::LineKind>(line) == LineKind::mains)) {
    bound.square = std::max(bound.square, analysis::expected_background(measured));
  }
  return bound;
}

LineBounds::Bound LineBounds::bound_of_mains(const ChannelLines& channel,
                                             const analysis::UnresolvedLine& line,
                                             const StepOfChannel& where) const {
  Bound bound =
      bound_of({channel.channel, LineKind::mains, line.line_hz, 0}, where, channel.amplitude, {});
  if (bound.from_driven_steps) {
    return bound;
  }
  std::vector<analysis::MeasuredBackground> measured;
  for (const double kindred_hz : kindred_lines_hz(line)) {
    for (const Measured& one : driven({channel.channel, LineKind::mains, kindred_hz, 0})) {
      measured.push_back({one.line, one.excitation});
    }
  }
  const auto power = analysis::significant_background(measured, channel.amplitude);
  bound.from_driven_steps = !measured.empty() && !power && !bound.significant;
  bound.square = std::max(bound.square, power ? *power : analysis::expected_background(measured));
  return bound;
}

std::optional<double> LineBounds::square_of_harmonic(const std::string& channel, int order) const {
  std::vector<analysis::MeasuredAmplitude> amplitudes;
  for (const Measured& one :
       driven({channel, LineKind::harmonic, 0.0, std::min(order, first_high_order)})) {
    amplitudes.push_back(one.line);
  }
  return analysis::square_of_amplitude(amplitudes);
}

LineBounds::SettledMains LineBounds::settle_mains(const ChannelLines& channel,
                                                  StepResult& result) const {
  double u2 = 0.0;
  double beats = 0.0;
  for (const analysis::UnresolvedLine& line : channel.unresolved) {
    if (!is_of_mains(line)) {
      continue;
    }
    const Bound bound =
        bound_of_mains(channel, line, {channel.channel, result.step, result.repetition});
    if (!bound.from_driven_steps) {
      result.flags.push_back(flag_of_line(channel.channel, line));
    }
    const double h = std::sqrt(bound.square);
    const double u =
        analysis::line_uncertainty(line, h, channel.amplitude, channel.duration_s).u_phase_rad;
    u2 += u * u;
    if (bound.significant) {
      beats += analysis::largest_beat_rel(line, h, channel.amplitude, channel.duration_s);
    }
  }
  add_half_repeating({.kind = ContributionKind::mains_hum, .subject = channel.subject},
                     alike(channel, u2), result);
  return {u2, beats};
}

double LineBounds::background_of(const ChannelLines& channel, const StepResult& result) const {
  if (!(channel.amplitude > 0.0)) {
    return 0.0;
  }
  const Bound bound = bound_of({channel.channel, LineKind::background, channel.frequency_hz, 0},
                               {channel.channel, result.step, result.repetition}, channel.amplitude,
                               {noise_held(result) * channel.amplitude, channel.duration_s});
  return bound.significant ? 0.5 * bound.square / (channel.amplitude * channel.amplitude) : 0.0;
}

void LineBounds::settle_backgrounds(std::span<const double> of_mains, StepResult& result) const {
  std::vector<Variances> backgrounds;
  Variances all;
  for (std::size_t i = 0; i < result.lines.size(); ++i) {
    const ChannelLines& channel = result.lines[i];
    backgrounds.push_back(
        alike(channel, std::max(0.0, background_of(channel, result) - of_mains[i])));
    all.magnitude += backgrounds.back().magnitude;
    all.phase += backgrounds.back().phase;
  }
  const Variances scatter = scatter_of(result);
  const double of_magnitude = share_beyond(scatter.magnitude, all.magnitude);
  const double of_phase = share_beyond(scatter.phase, all.phase);
  for (std::size_t i = 0; i < backgrounds.size(); ++i) {
    add_half_repeating({.kind = ContributionKind::background, .subject = result.lines[i].subject},
                       {of_magnitude * backgrounds[i].magnitude, of_phase * backgrounds[i].phase},
                       result);
  }
}

void LineBounds::settle_harmonics(const ChannelLines& channel, StepResult& result) const {
  double u2 = 0.0;
  for (const analysis::UnresolvedLine& line : channel.unresolved) {
    if (is_of_mains(line)) {
      continue;
    }
    const auto square = square_of_harmonic(channel.channel, line.order);
    if (!square) {
      result.flags.push_back(flag_of_line(channel.channel, line));
      continue;
    }
    const double u =
        analysis::line_uncertainty(line, std::sqrt(*square), 1.0, channel.duration_s).u_phase_rad;
    u2 += u * u;
  }
  add_row({.kind = ContributionKind::folded_harmonic, .subject = channel.subject},
          alike(channel, u2), result);
}

StepResult LineBounds::settled(StepResult result) const {
  result.flags.erase(std::remove_if(result.flags.begin(), result.flags.end(), is_of_line),
                     result.flags.end());
  double beats = 0.0;
  std::vector<double> of_mains;
  for (const ChannelLines& channel : result.lines) {
    const SettledMains mains = settle_mains(channel, result);
    beats += mains.beats;
    of_mains.push_back(mains.u2);
    settle_harmonics(channel, result);
  }
  settle_backgrounds(of_mains, result);
  if (result.change &&
      std::hypot(result.change->magnitude_rel, result.change->phase_rad) <= beats) {
    result.change.reset();
    std::erase_if(result.flags,
                  [](const Flag& flag) { return flag.kind == ResultFlag::changed_within_step; });
  }
  result.provisional = false;
  return result;
}

} // namespace dyncal::inline evaluation
