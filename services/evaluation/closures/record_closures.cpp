#include "services/evaluation/closures/record_closures.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/core.h>

#include "analysis/base/statistics.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double ends_samples = 2.0;
constexpr std::size_t least_steps = 3;

Closure level(const ChannelRun& run) {
  if (!is_acceleration(run.reference_unit)) {
    return not_possible(ClosureKind::level, "",
                        "the reference does not read m/s^2, in which the level is asked for");
  }
  std::optional<Closure> worst;
  for (const StepResult* result : run.results) {
    if (!(result->level_m_s2 > 0.0)) {
      continue;
    }
    const double measured_m_s2 = result->fits.front().fit.amplitude();
    const double off = measured_m_s2 / result->level_m_s2 - 1.0;
    if (!worst || std::abs(off) > std::abs(worst->value)) {
      worst = judged(ClosureKind::level, run.place_of(*result),
                     {off, 0.0, run.recipe.level_deviation_rel, "1"},
                     fmt::format("at {} (repetition {}) the level is off most: {:.4g} m/s^2 in "
                                 "place of {:.4g} m/s^2",
                                 run.place_of(*result), result->repetition, measured_m_s2,
                                 result->level_m_s2));
    }
  }
  if (!worst) {
    return not_possible(ClosureKind::level, "", "no level was asked for");
  }
  if (is_open(*worst)) {
    worst->sentence += ": look at the amplifier, and at the unit of the reference";
  }
  return *worst;
}

struct Counted {
  const StepResult* step = nullptr;
  double samples = 0.0;  // from the first to the last one
  double left_out = 0.0; // of them, or before the first or behind the last
  double seconds = 0.0;

  // Samples that nothing accounts for; < 0: too few.
  [[nodiscard]] double beyond(double rate_hz) const {
    const double expected = rate_hz * seconds;
    return samples < expected ? samples - expected : std::max(0.0, samples - left_out - expected);
  }
};

std::vector<Counted> counts_of(const ChannelRun& run, const std::string& source) {
  std::vector<Counted> counts;
  for (const StepResult* result : run.results) {
    for (const SourceSamples& one : result->samples) {
      if (one.source == source && one.used > 1 && one.last_stamp_ns > one.first_stamp_ns) {
        const auto left_out = one.all_lost() + one.not_trusted + one.not_measured + one.cut_out;
        counts.push_back({result, static_cast<double>(one.used + left_out - 1),
                          static_cast<double>(left_out),
                          1e-9 * static_cast<double>(one.last_stamp_ns - one.first_stamp_ns)});
      }
    }
  }
  return counts;
}

// Of the step that is off most, against the usual rate of all.
Closure counted(const ChannelRun& run, const std::string& source) {
  const std::vector<Counted> counts = counts_of(run, source);
  if (counts.size() < least_steps) {
    return not_possible(
        ClosureKind::samples_counted, source,
        fmt::format("{} steps with stamps are too few to tell one from the others", counts.size()));
  }
  std::vector<double> rates_hz, off;
  for (const Counted& one : counts) {
    rates_hz.push_back(one.samples / one.seconds);
  }
  const double rate_hz = analysis::median(rates_hz);
  for (const Counted& one : counts) {
    off.push_back(std::abs(one.beyond(rate_hz)));
  }
  const auto worst = std::max_element(off.begin(), off.end());
  const Counted& step = counts[static_cast<std::size_t>(worst - off.begin())];
  const double difference = step.beyond(rate_hz);
  const double usual = analysis::mad_to_sd * analysis::median(off);
  const double limit = std::max(
      ends_samples, usual * limit_by_chance(counts.size(), static_cast<double>(counts.size() - 1)));
  const bool fits = std::abs(difference) <= limit;
  return judged(
      ClosureKind::samples_counted, source, {difference, 0.0, limit, "1"},
      fmt::format("{}: at {} Hz (repetition {}) samples evaluated and lost are {:.1f} {} than the "
                  "time takes at the run's rate{}",
                  source, step.step->frequency_text_hz, step.step->repetition, std::abs(difference),
                  difference < 0.0 ? "fewer" : "more",
                  fits ? "" : ": samples were lost or doubled without a trace"));
}

} // namespace

std::vector<Closure> record_closures(const ChannelRun& run) {
  std::vector<Closure> all{level(run)};
  if (run.recipe.method() == EvaluationMethod::series_timestamping) {
    all.push_back(not_possible(ClosureKind::samples_counted, "",
                               "the samples of a triggered series have no stamps"));
    return all;
  }
  std::set<std::string> sources;
  for (const SourceSamples& one : run.results.front()->samples) {
    sources.insert(one.source);
  }
  for (const std::string& source : sources) {
    all.push_back(counted(run, source));
  }
  return all;
}

} // namespace dyncal::inline evaluation
