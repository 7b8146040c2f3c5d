#include "services/evaluation/method/line_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace dyncal::services {
namespace {

using analysis::LineAmplitude;
using analysis::LineKind;

constexpr double shorter = 0.7;         // steps may be shorter than this one by so much
constexpr double min_quiet_periods = 5; // of a line, in quiet time

struct WantedLine {
  LineKind kind;
  double line_hz; // of the mains
  int order;      // of a harmonic
};

double rate_of(std::span<const std::int64_t> stamps_ns) {
  return static_cast<double>(stamps_ns.size() - 1) * 1e9 /
         static_cast<double>(stamps_ns.back() - stamps_ns.front());
}

double duration_of(std::span<const std::int64_t> stamps_ns) {
  return static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
}

// Lines that a step of the recipe may not tell from its excitation.
std::vector<WantedLine> wanted_lines(const Recipe& recipe, double duration_s, double rate_hz) {
  std::vector<WantedLine> wanted;
  for (const RecipeStep& step : recipe.steps) {
    for (const analysis::UnresolvedLine& line :
         analysis::unresolved_lines(step.frequency.hz(), shorter * duration_s, rate_hz)) {
      const WantedLine one = line.kind == LineKind::mains
                                 ? WantedLine{LineKind::mains, line.line_hz, 0}
                                 : WantedLine{LineKind::harmonic, 0.0, line.order};
      const bool known = std::any_of(wanted.begin(), wanted.end(), [&](const WantedLine& other) {
        return other.kind == one.kind && other.line_hz == one.line_hz && other.order == one.order;
      });
      if (!known) {
        wanted.push_back(one);
      }
    }
  }
  return wanted;
}

void measure_in_step(const std::vector<WantedLine>& wanted, const analysis::ChannelFit& fit,
                     std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                     ChannelLines& lines) {
  const double f = fit.frequency.hz();
  const double rate_hz = rate_of(stamps_ns);
  std::vector<double> residuals;
  for (const WantedLine& one : wanted) {
    const double line_hz = one.kind == LineKind::mains ? one.line_hz : one.order * f;
    if (!analysis::is_resolved(line_hz, one.order, f, lines.duration_s, rate_hz)) {
      continue;
    }
    if (residuals.empty()) {
      residuals =
          analysis::residuals_of(fit.frequency, fit.fit, fit.phase_origin_ns, stamps_ns, values);
    }
    if (const auto line = analysis::measure_line(line_hz, stamps_ns, residuals)) {
      const double unit = one.kind == LineKind::mains ? 1.0 : lines.amplitude;
      lines.measured.push_back(
          {one.kind, one.line_hz, one.order, {line->amplitude / unit, line->u_component / unit}});
    }
  }
}

void measure_in_quiet(const std::vector<WantedLine>& wanted, const StepSamples& quiet,
                      std::size_t column, ChannelLines& lines) {
  const auto& stamps_ns = quiet.stamps_ns;
  if (stamps_ns.size() < 3) {
    return;
  }
  const double duration_s = duration_of(stamps_ns);
  for (const WantedLine& one : wanted) {
    const double rate_hz = rate_of(stamps_ns);
    const double seen_hz = analysis::folded_hz(one.line_hz, rate_hz);
    if (one.kind != LineKind::mains || seen_hz * duration_s < min_quiet_periods ||
        (0.5 * rate_hz - seen_hz) * duration_s < min_quiet_periods) {
      continue;
    }
    const auto values = quiet.columns[column];
    const std::size_t half = values.size() / 2;
    auto chosen = analysis::measure_line(one.line_hz, stamps_ns, values);
    const auto early =
        analysis::measure_line(one.line_hz, stamps_ns.first(half), values.first(half));
    const auto late =
        analysis::measure_line(one.line_hz, stamps_ns.subspan(half), values.subspan(half));
    if (early && late &&
        std::abs(early->amplitude - late->amplitude) >
            4.0 * std::hypot(early->u_component, late->u_component)) {
      chosen = early->amplitude < late->amplitude ? early : late;
    }
    if (chosen) {
      lines.measured.push_back(
          {one.kind, one.line_hz, 0, {chosen->amplitude, chosen->u_component}});
    }
  }
}

struct StepLines {
  ChannelLines lines;
  std::vector<WantedLine> wanted;
};

StepLines check_step(const Recipe& recipe, const LineSubject& subject,
                     const analysis::ChannelFit& fit, std::span<const std::int64_t> stamps_ns,
                     std::span<const double> values) {
  StepLines found;
  ChannelLines& lines = found.lines;
  lines.channel = fit.channel;
  lines.subject = subject.name;
  lines.counts_in_magnitude = subject.counts_in_magnitude;
  lines.amplitude = fit.fit.amplitude();
  if (stamps_ns.size() < 3 || !(lines.amplitude > 0.0)) {
    return found;
  }
  lines.duration_s = duration_of(stamps_ns);
  const double rate_hz = rate_of(stamps_ns);
  lines.unresolved = analysis::unresolved_lines(fit.frequency.hz(), lines.duration_s, rate_hz);
  found.wanted = wanted_lines(recipe, lines.duration_s, rate_hz);
  measure_in_step(found.wanted, fit, stamps_ns, values, lines);
  return found;
}

} // namespace

ChannelLines check_lines(const Recipe& recipe, const LineSubject& subject,
                         const analysis::ChannelFit& fit, std::span<const std::int64_t> stamps_ns,
                         std::span<const double> values) {
  return check_step(recipe, subject, fit, stamps_ns, values).lines;
}

ChannelLines check_lines(const Recipe& recipe, const LineSubject& subject,
                         const analysis::ChannelFit& fit, const SelectedChannels& selected,
                         std::size_t index) {
  StepLines found =
      check_step(recipe, subject, fit, selected.stamps_ns(), selected.channel(index).values);
  if (!found.wanted.empty()) {
    measure_in_quiet(found.wanted, selected.quiet_samples(), index, found.lines);
  }
  return std::move(found.lines);
}

void add_lines(std::vector<ChannelLines> lines, StepResult& result) {
  if (!result.valid) {
    return;
  }
  for (const ChannelLines& channel : lines) {
    for (const analysis::UnresolvedLine& line : channel.unresolved) {
      result.provisional = true;
      result.flags.push_back(flag_of_line(channel.channel, line));
    }
  }
  result.lines = std::move(lines);
}

Flag flag_of_line(const std::string& channel, const analysis::UnresolvedLine& line) {
  if (line.kind == LineKind::mains) {
    return {ResultFlag::mains_not_separated,
            fmt::format("{}: hum at {} Hz {}", channel, line.line_hz,
                        to_string(ResultFlag::mains_not_separated))};
  }
  return {ResultFlag::harmonic_not_separated,
          fmt::format("{}: harmonic {} {}", channel, line.order,
                      to_string(ResultFlag::harmonic_not_separated))};
}

} // namespace dyncal::services
