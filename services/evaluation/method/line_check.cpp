#include "services/evaluation/method/line_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "analysis/interferometer/reference_motion.hpp"
#include "analysis/sine/background_spectrum.hpp"
#include "analysis/sine/stationary_line.hpp"
#include "services/contract/excitation_quantity.hpp"

namespace dyncal::inline evaluation {
namespace {

using analysis::LineAmplitude;
using analysis::LineKind;

constexpr double shorter = 0.7; // steps may be shorter than this one by so much

struct WantedLine {
  LineKind kind;
  double line_hz; // of the mains, of a background
  int order;      // of a harmonic

  friend bool operator==(const WantedLine&, const WantedLine&) = default;
};

double rate_of(std::span<const std::int64_t> stamps_ns) {
  return static_cast<double>(stamps_ns.size() - 1) * 1e9 /
         static_cast<double>(stamps_ns.back() - stamps_ns.front());
}

double duration_of(std::span<const std::int64_t> stamps_ns) {
  return static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
}

WantedLine wanted_line(const analysis::UnresolvedLine& line) {
  return line.kind == LineKind::mains ? WantedLine{LineKind::mains, line.line_hz, 0}
                                      : WantedLine{LineKind::harmonic, 0.0, line.order};
}

// What a step cannot tell from its excitation: lines of the mains with their kindred, harmonics,
// and whatever else there may be at its frequency.
std::vector<WantedLine> wanted_of(double frequency_hz,
                                  const std::vector<analysis::UnresolvedLine>& unresolved) {
  std::vector<WantedLine> wanted;
  for (const analysis::UnresolvedLine& line : unresolved) {
    wanted.push_back(wanted_line(line));
    for (const double kindred_hz : kindred_lines_hz(line)) {
      wanted.push_back({LineKind::mains, kindred_hz, 0});
    }
  }
  wanted.push_back({LineKind::background, frequency_hz, 0});
  return wanted;
}

// Of all steps of the recipe, if they are as short as they may be.
std::vector<WantedLine> wanted_lines(const Recipe& recipe, double duration_s, double rate_hz) {
  std::vector<WantedLine> wanted;
  std::vector<double> frequencies_hz;
  for (const RecipeStep& step : recipe.steps) {
    const double f = step.frequency.hz();
    if (std::find(frequencies_hz.begin(), frequencies_hz.end(), f) != frequencies_hz.end()) {
      continue;
    }
    frequencies_hz.push_back(f);
    for (const WantedLine& one : wanted_of(
             f, analysis::unresolved_lines(f, shorter * duration_s, rate_hz, recipe.mains_hz))) {
      if (std::find(wanted.begin(), wanted.end(), one) == wanted.end()) {
        wanted.push_back(one);
      }
    }
  }
  return wanted;
}

MeasuredLine measured_line(const WantedLine& line, const LineAmplitude& found, double unit) {
  return {line.kind, line.line_hz, line.order, {found.amplitude / unit, found.u_component / unit}};
}

void measure_in_step(const std::vector<WantedLine>& wanted, const analysis::ChannelFit& fit,
                     std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                     ChannelLines& lines) {
  const double f = fit.frequency.hz();
  const double rate_hz = rate_of(stamps_ns);
  double highest_hz = 0.0;
  for (const WantedLine& one : wanted) {
    highest_hz = std::max(highest_hz, analysis::folded_hz(one.line_hz, rate_hz));
  }
  const std::vector<double> residuals =
      analysis::residuals_of(fit.frequency, fit.fit, fit.phase_origin_ns, stamps_ns, values);
  const auto background =
      highest_hz > 0.0
          ? analysis::BackgroundSpectrum::of_residuals(f, highest_hz, stamps_ns, residuals)
          : std::nullopt;
  for (const WantedLine& one : wanted) {
    if (one.kind != LineKind::harmonic) {
      const auto found =
          background ? background->line(analysis::folded_hz(one.line_hz, rate_hz)) : std::nullopt;
      if (found) {
        lines.measured.push_back(measured_line(one, *found, 1.0));
      }
    } else if (analysis::is_resolved(one.order * f, one.order, f, lines.duration_s, rate_hz)) {
      if (const auto found = analysis::measure_line(one.order * f, stamps_ns, residuals)) {
        lines.measured.push_back(measured_line(one, *found, lines.amplitude));
      }
    }
  }
}

// An exciter rings down in the beginning of quiet time: what its later parts show counts, if the
// whole of it does not last.
void measure_in_quiet(const std::vector<WantedLine>& wanted,
                      std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                      ChannelLines& lines) {
  if (stamps_ns.size() < 3) {
    return;
  }
  const double rate_hz = rate_of(stamps_ns);
  for (const WantedLine& one : wanted) {
    const bool own = one.kind == LineKind::background && one.line_hz == lines.frequency_hz;
    if (one.kind != LineKind::mains && !own) {
      continue;
    }
    const double seen_hz = analysis::folded_hz(one.line_hz, rate_hz);
    for (const std::size_t part : {1, 2, 4}) {
      const std::size_t first = stamps_ns.size() - stamps_ns.size() / part;
      const auto found = analysis::measure_stationary_line(
          one.line_hz, seen_hz, stamps_ns.subspan(first), values.subspan(first));
      if (found) {
        lines.in_quiet.push_back(measured_line(one, *found, 1.0));
        break;
      }
    }
  }
}

// Below all that is looked for: what a displacement does there is slow motion of the table.
double slowest_of(const Recipe& recipe) {
  double slowest_hz = std::numeric_limits<double>::infinity();
  for (const double line_hz : recipe.mains_hz) {
    slowest_hz = std::min(slowest_hz, line_hz);
  }
  for (const RecipeStep& step : recipe.steps) {
    slowest_hz = std::min(slowest_hz, step.frequency.hz());
  }
  return slowest_hz;
}

struct StepLines {
  ChannelLines lines;
  std::vector<WantedLine> wanted;
};

// Of the step whose excitation was found here.
double planned_hz(const Recipe& recipe, double found_hz) {
  double nearest_hz = found_hz;
  double distance_hz = std::numeric_limits<double>::infinity();
  for (const RecipeStep& step : recipe.steps) {
    if (std::abs(step.frequency.hz() - found_hz) < distance_hz) {
      nearest_hz = step.frequency.hz();
      distance_hz = std::abs(nearest_hz - found_hz);
    }
  }
  return nearest_hz;
}

StepLines check_step(const Recipe& recipe, const LineSubject& subject,
                     const analysis::ChannelFit& fit, std::span<const std::int64_t> stamps_ns,
                     std::span<const double> values) {
  StepLines found;
  ChannelLines& lines = found.lines;
  lines.channel = fit.channel;
  lines.subject = subject.name;
  lines.counts_in_magnitude = subject.counts_in_magnitude;
  lines.frequency_hz = planned_hz(recipe, fit.frequency.hz());
  lines.amplitude = fit.fit.amplitude();
  if (stamps_ns.size() < 3 || !(lines.amplitude > 0.0)) {
    return found;
  }
  lines.duration_s = duration_of(stamps_ns);
  const double rate_hz = rate_of(stamps_ns);
  lines.unresolved =
      analysis::unresolved_lines(fit.frequency.hz(), lines.duration_s, rate_hz, recipe.mains_hz);
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
  const bool moves = quadrature_signals_of(selected.record().description(),
                                           selected.description(index).name) != nullptr;
  const double slowest_hz = slowest_of(recipe);
  const auto without_drift = [&](std::span<const std::int64_t> stamps_ns,
                                 std::span<const double> values) {
    return moves ? analysis::without_slow_motion(slowest_hz, stamps_ns, values)
                 : std::vector<double>{};
  };
  const std::span<const double> values = selected.channel(index).values;
  const std::vector<double> without = without_drift(selected.stamps_ns(), values);
  StepLines found = check_step(recipe, subject, fit, selected.stamps_ns(),
                               moves ? std::span<const double>(without) : values);
  if (!found.wanted.empty()) {
    const StepSamples quiet = selected.quiet_samples();
    const auto column = quiet.columns.empty() ? std::span<const double>() : quiet.columns[index];
    const std::vector<double> still = without_drift(quiet.stamps_ns, column);
    measure_in_quiet(found.wanted, quiet.stamps_ns, moves ? std::span<const double>(still) : column,
                     found.lines);
  }
  return std::move(found.lines);
}

std::vector<double> kindred_lines_hz(const analysis::UnresolvedLine& line) {
  std::vector<double> kindred;
  if (line.kind == LineKind::mains) {
    const int lowest = line.order % 2 == 0 ? 2 : 1;
    for (const int order : {lowest, lowest + 2}) {
      if (order != line.order) {
        kindred.push_back(line.line_hz / line.order * order);
      }
    }
  }
  return kindred;
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

} // namespace dyncal::inline evaluation
