#include "services/evaluation/closures/clock_closures.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/core.h>

namespace dyncal::inline evaluation {
namespace {

constexpr double own_oscillator_rel = 0.05;
constexpr double warm_up_rel = 1e-6;
constexpr std::size_t least_steps = 4;

struct Ratio {
  const StepResult* step = nullptr;
  double rel = 0.0;
  double u_rel = 0.0;
};

// Of sync in both clocks, which are the second and third fit.
std::vector<Ratio> ratios_of(const ChannelRun& run) {
  std::vector<Ratio> ratios;
  for (const StepResult* result : run.results) {
    if (result->fits.size() < 3) {
      continue;
    }
    const analysis::ChannelFit& acs = result->fits[1];
    const analysis::ChannelFit& dau = result->fits[2];
    const double rel = acs.frequency.hz() / dau.frequency.hz() - 1.0;
    ratios.push_back(
        {result, rel, std::hypot(acs.u_frequency_hz, dau.u_frequency_hz) / result->frequency_hz});
  }
  return ratios;
}

double mean_of(const std::vector<Ratio>& ratios) {
  double sum = 0.0;
  for (const Ratio& one : ratios) {
    sum += one.rel / static_cast<double>(ratios.size());
  }
  return sum;
}

// Standard deviation, but not less than what single steps are known to.
double scatter_of(const std::vector<Ratio>& ratios) {
  const double mean = mean_of(ratios);
  double squares = 0.0, stated = 0.0;
  for (const Ratio& one : ratios) {
    squares += std::pow(one.rel - mean, 2) / static_cast<double>(ratios.size() - 1);
    stated += one.u_rel * one.u_rel / static_cast<double>(ratios.size());
  }
  return std::sqrt(std::max(squares, stated));
}

Closure rate(const std::string& clocks, const std::vector<Ratio>& ratios, double tolerance_rel) {
  const double mean = mean_of(ratios);
  const double count = static_cast<double>(ratios.size());
  const double u = ratios.size() > 1 ? scatter_of(ratios) / std::sqrt(count) : ratios[0].u_rel;
  const double limit = tolerance_rel + limit_by_chance(1) * u;
  const bool fits = std::abs(mean) <= limit;
  return judged(
      ClosureKind::clock_rate, clocks, {mean, u, limit, "1"},
      fmt::format("{}: the clocks differ by {:.4g} ppm{}", clocks, 1e6 * mean,
                  fits ? ""
                       : fmt::format(", more than crystals do ({:.4g} ppm): a rate is set wrong, "
                                     "or a clock is broken",
                                     1e6 * limit)));
}

// The step that differs most from all others, in what chance leaves it.
Closure in_each_step(const ChannelRun& run, const std::string& clocks,
                     const std::vector<Ratio>& ratios) {
  if (ratios.size() < least_steps) {
    return not_possible(
        ClosureKind::clock_ratio, clocks,
        fmt::format("{} steps are too few to tell one from the others", ratios.size()));
  }
  std::optional<Closure> worst;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    std::vector<Ratio> others = ratios;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const double n = static_cast<double>(others.size());
    const double u = std::hypot(std::max(scatter_of(others), ratios[i].u_rel),
                                scatter_of(others) / std::sqrt(n));
    const double limit = std::max(warm_up_rel, limit_by_chance(ratios.size(), n - 1.0) * u);
    const double off = ratios[i].rel - mean_of(others);
    if (!worst || std::abs(off) / limit > std::abs(worst->value) / worst->limit) {
      const StepResult& step = *ratios[i].step;
      worst = judged(ClosureKind::clock_ratio, clocks, {off, u, limit, "1"},
                     fmt::format("{}: of all steps that at {} (repetition {}) is off most, by "
                                 "{:.3g} ppm",
                                 clocks, run.place_of(step), step.repetition, 1e6 * off));
    }
  }
  if (is_open(*worst)) {
    worst->sentence += fmt::format(", and chance leaves it {:.3g} ppm: a clock was set, or its "
                                   "samples are not of this step",
                                   1e6 * worst->limit);
  }
  return *worst;
}

// Worst step; of the clock that records the reference, or, where none does, the sensor.
Closure asked_frequency(const ChannelRun& run) {
  std::optional<Closure> worst;
  for (const StepResult* result : run.results) {
    const std::size_t sync = run.recipe.reference_table.empty() ? 1 : 2;
    const analysis::ChannelFit& fit = result->fits[std::min(sync, result->fits.size() - 1)];
    const double off = fit.frequency.hz() / result->frequency_hz - 1.0;
    const double u = fit.u_frequency_hz / result->frequency_hz;
    const double limit =
        2.0 * run.recipe.clock_tolerance_rel + limit_by_chance(run.results.size()) * u;
    if (!worst || std::abs(off) / limit > std::abs(worst->value) / worst->limit) {
      worst = judged(ClosureKind::excitation_frequency, run.place_of(*result), {off, u, limit, "1"},
                     fmt::format("the excitation at {} is off most, by {:.4g} ppm",
                                 run.place_of(*result), 1e6 * off));
    }
  }
  if (is_open(*worst)) {
    worst->sentence += fmt::format(", where two crystals leave it {:.4g} ppm: look at the "
                                   "generator's setting and at the rate of the ACS",
                                   1e6 * worst->limit);
  }
  return *worst;
}

Closure own_oscillator(const ChannelRun& run) {
  const std::string source = source_of(run.function.channel);
  const StepResult& last = *run.results.back();
  if (!last.series || !(run.nominal_rate_hz > 0.0)) {
    return not_possible(ClosureKind::clock_rate, source, "the sensor states no sample rate");
  }
  const double off = last.series->sample_rate_hz / run.nominal_rate_hz - 1.0;
  const double u = last.series->u_sample_rate_hz / run.nominal_rate_hz;
  const double limit = own_oscillator_rel + limit_by_chance(1) * u;
  const bool fits = std::abs(off) <= limit;
  return judged(ClosureKind::clock_rate, source, {off, u, limit, "1"},
                fmt::format("{} samples {:.4g} % faster than it states{}", source, 1e2 * off,
                            fits ? ""
                                 : ", more than oscillators of sensors do: look at the rate that "
                                   "the sensor was set to"));
}

// Sync against the stamps of both clocks. What is uncertain of either link is mostly the same in
// all steps, so that their mean is not known better than the best of them.
Closure links_of(const ChannelRun& run) {
  const StepResult* best = nullptr;
  for (const StepResult* result : run.results) {
    if (result->clock_link &&
        (best == nullptr || result->clock_link->u_offset_s() < best->clock_link->u_offset_s())) {
      best = result;
    }
  }
  if (best == nullptr) {
    return not_possible(ClosureKind::clock_links, "",
                        "not both clocks have UTC with a stated uncertainty beside sync");
  }
  constexpr double largest_en = 2.0;
  const analysis::ClockLink& link = *best->clock_link;
  const RoleNames& roles = run.recipe.roles;
  const std::string clocks = roles.sync_acs.source + " and " + roles.sync_sensor.source;
  const double u = link.u_offset_s();
  const double limit = largest_en * 2.0 * u;
  const bool agree = std::abs(link.offset_s) <= limit;
  return judged(ClosureKind::clock_links, clocks, {link.offset_s, u, limit, "s"},
                fmt::format("{}: by sync at {} the clocks are {:.3g} us apart, of which their UTC "
                            "knows nothing{}",
                            clocks, run.place_of(*best), 1e6 * link.offset_s,
                            agree ? ""
                                  : fmt::format("; their uncertainties leave it {:.3g} us: the "
                                                "response of the sync ADC, a delay or a clock is "
                                                "not as stated",
                                                1e6 * limit)));
}

} // namespace

std::vector<Closure> clock_closures(const ChannelRun& run) {
  std::vector<Closure> all;
  const EvaluationMethod method = run.recipe.method();
  const bool searched = run.recipe.frequency_search_rel > 0.0;
  const std::string known = "the frequency was not searched for: the bench file says that both "
                            "clocks know it exactly";
  if (method == EvaluationMethod::series_timestamping) {
    all.push_back(own_oscillator(run));
  } else if (const auto ratios = ratios_of(run); run.recipe.reference_table.empty() &&
                                                 method == EvaluationMethod::sample_timestamping &&
                                                 searched && !ratios.empty()) {
    const RoleNames& roles = run.recipe.roles;
    const std::string clocks = roles.sync_acs.source + " and " + roles.sync_sensor.source;
    all.push_back(rate(clocks, ratios, run.recipe.clock_tolerance_rel));
    all.push_back(in_each_step(run, clocks, ratios));
  } else {
    const std::string why = !run.recipe.reference_table.empty()
                                ? "the reference is a table, and no clock of it is known"
                            : method == EvaluationMethod::analogue
                                ? "sensor and reference have one clock"
                            : method == EvaluationMethod::absolute_time ? "both clocks follow UTC"
                                                                        : known;
    all.push_back(not_possible(ClosureKind::clock_rate, "", why));
    all.push_back(not_possible(ClosureKind::clock_ratio, "", why));
  }
  all.push_back(searched ? asked_frequency(run)
                         : not_possible(ClosureKind::excitation_frequency, "", known));
  all.push_back(links_of(run));
  return all;
}

Closure clocks_of_channels(const ChannelRun& one, const ChannelRun& other) {
  constexpr auto kind = ClosureKind::channel_clocks;
  const std::string subject = one.function.channel + " and " + other.function.channel;
  std::optional<Closure> worst;
  for (const StepResult* a : one.results) {
    const StepResult* b = in_same_step(*a, other);
    if (b == nullptr || !a->series || !b->series) {
      continue;
    }
    const double off = b->series->sample_rate_hz / a->series->sample_rate_hz - 1.0;
    const double u = std::hypot(a->series->u_sample_rate_hz, b->series->u_sample_rate_hz) /
                     a->series->sample_rate_hz;
    const double limit = limit_by_chance(one.results.size()) * u;
    if (!worst || std::abs(off) * worst->limit > std::abs(worst->value) * limit) {
      worst = judged(kind, subject, {off, u, limit, "1"},
                     fmt::format("{}: of all steps their rates differ most at {}, by {:.3g} ppm",
                                 subject, one.place_of(*a), 1e6 * off));
    }
  }
  if (!worst) {
    return not_possible(kind, subject, "the channels of the sensor have common stamps");
  }
  if (is_open(*worst)) {
    worst->sentence += fmt::format(", and chance leaves them {:.3g} ppm: a sensor has one clock, "
                                   "so one of them follows another signal than the excitation",
                                   1e6 * worst->limit);
  }
  return *worst;
}

} // namespace dyncal::inline evaluation
