#include "services/evaluation/closures/phase_closures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "services/evaluation/result/members.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double most_beside = 3.0; // u of the phases
constexpr const char* one_kind = R"(\one)";

// How much larger u of the phases is than the part that the line was weighted with: what all
// frequencies share, as the reference's phase, may still be another at each of them.
double whole_u_over_independent(const ChannelRun& run) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const FrequencyPoint& point : run.function.points) {
    if (point.mean.u_independent_phase_rad > 0.0) {
      squares += std::pow(point.mean.u_phase_rad / point.mean.u_independent_phase_rad, 2);
      ++count;
    }
  }
  return count == 0 ? 1.0 : std::max(1.0, std::sqrt(squares / static_cast<double>(count)));
}

Closure line(const ChannelRun& run, const analysis::GroupDelay& delay) {
  if (!(delay.degrees_of_freedom > 0.0)) {
    return not_possible(ClosureKind::delay_fit, "", "two frequencies always lie on a line");
  }
  const double beside =
      std::sqrt(delay.chi_squared / delay.degrees_of_freedom) / whole_u_over_independent(run);
  const double by_chance = std::sqrt(chi_squared_by_chance(1, delay.degrees_of_freedom));
  const double limit = std::max(most_beside, by_chance);
  return judged(
      ClosureKind::delay_fit, "", {beside, 0.0, limit, "1"},
      fmt::format("the phases lie {:.3g} of their u beside a line with the delay {:.6g} "
                  "ms (chi-squared {:.4g} of {:.0f}){}",
                  beside, 1e3 * delay.delay_s, delay.chi_squared, delay.degrees_of_freedom,
                  beside > limit ? ": single phases are wrong, or the sensor has no constant delay "
                                   "here, as near a resonance or a filter's edge: say so by "
                                   "dut_phase = \"any\" in [method]"
                                 : ""));
}

// An alternative makes no phase wrong, but which delay it is nobody can tell.
Closure alternatives(const analysis::GroupDelay& delay) {
  constexpr auto kind = ClosureKind::delay_alternatives;
  const auto nearest = std::min_element(
      delay.alternatives_s.begin(), delay.alternatives_s.end(), [&](double a, double b) {
        return std::abs(a - delay.delay_s) < std::abs(b - delay.delay_s);
      });
  if (nearest == delay.alternatives_s.end()) {
    return judged(kind, "", {0.0, 0.0, 0.0, "1"},
                  "no other delay that a sensor may have fits as well");
  }
  return not_possible(
      kind, "",
      fmt::format("{:.6g} ms fit as well as {:.6g} ms: a frequency less than {:.3g} "
                  "Hz from another one would tell",
                  1e3 * *nearest, 1e3 * delay.delay_s, 1.0 / std::abs(*nearest - delay.delay_s)));
}

const char* expected_at_zero(DutPhase phase) {
  return phase == DutPhase::delay_from_0     ? "0"
         : phase == DutPhase::delay_from_180 ? "180"
                                             : "0 or 180";
}

double from_expected(DutPhase phase, double intercept_rad) {
  constexpr double pi = std::numbers::pi;
  return phase == DutPhase::delay_from_0     ? std::remainder(intercept_rad, 2.0 * pi)
         : phase == DutPhase::delay_from_180 ? std::remainder(intercept_rad - pi, 2.0 * pi)
                                             : std::remainder(intercept_rad, pi);
}

Closure at_zero(const ChannelRun& run, const analysis::GroupDelay& delay, bool is_line) {
  constexpr auto kind = ClosureKind::phase_at_zero;
  if (run.function.unit != one_kind) {
    return not_possible(kind, "", "sensor and reference do not read quantities of one kind");
  }
  if (!is_line) {
    return not_possible(kind, "", "the phases are not on a line that could be followed to 0 Hz");
  }
  const double off = from_expected(run.recipe.dut_phase, delay.intercept_rad);
  const double limit = limit_by_chance(1) * delay.u_intercept_rad();
  return judged(kind, "", {off, delay.u_intercept_rad(), limit, "rad"},
                fmt::format("towards 0 Hz the phase tends to {:.4g} degrees (u {:.2g}){}",
                            degrees_of(delay.intercept_rad), degrees_of(delay.u_intercept_rad()),
                            std::abs(off) > limit
                                ? fmt::format(", where {} is expected: look at polarities, "
                                              "couplings and high-pass filters, and at the "
                                              "reference's phase",
                                              expected_at_zero(run.recipe.dut_phase))
                                : ""));
}

// Of the sensor's samples; 0 where nothing tells it.
double half_interval_s(const ChannelRun& run) {
  const StepResult& result = *run.results.front();
  if (result.series) {
    return 0.5 / result.series->sample_rate_hz;
  }
  const std::string source = source_of(run.function.channel);
  const auto found =
      std::find_if(result.samples.begin(), result.samples.end(), [&](const SourceSamples& one) {
        return one.source == source && one.used > 1 && one.last_stamp_ns > one.first_stamp_ns;
      });
  return found == result.samples.end()
             ? 0.0
             : 0.5e-9 * static_cast<double>(found->last_stamp_ns - found->first_stamp_ns) /
                   static_cast<double>(found->used + found->all_lost() - 1);
}

double step_u_phase(const StepResult& result) {
  return repetition_of(result).u_random_phase_rad;
}

} // namespace

std::vector<Closure> phase_closures(const ChannelRun& run) {
  if (!run.moves() || !run.function.group_delay) {
    const std::string why = !run.moves() ? "the channel hardly follows the excitation"
                                         : run.function.group_delay_problem;
    return {not_possible(ClosureKind::delay_fit, "", why),
            not_possible(ClosureKind::delay_alternatives, "", why),
            not_possible(ClosureKind::phase_at_zero, "", why)};
  }
  const analysis::GroupDelay& delay = *run.function.group_delay;
  const Closure fit = line(run, delay);
  return {fit, alternatives(delay), at_zero(run, delay, !is_open(fit))};
}

Closure delays_of_channels(const ChannelRun& one, const ChannelRun& other) {
  constexpr auto kind = ClosureKind::channel_delays;
  const std::string subject = one.function.channel + " and " + other.function.channel;
  if (one.recipe.dut_phase == DutPhase::any) {
    return not_possible(kind, subject, one.function.group_delay_problem);
  }
  if (!one.moves() || !other.moves()) {
    return not_possible(kind, subject, "one of them hardly follows the excitation");
  }
  double weights = 0.0, sum = 0.0;
  for (const StepResult* a : one.results) {
    const StepResult* b = in_same_step(*a, other);
    if (b == nullptr) {
      continue;
    }
    // A channel whose axis points the other way has the same delay.
    const double turned = std::remainder(b->phase_rad - a->phase_rad, std::numbers::pi);
    const double variance = std::pow(step_u_phase(*a), 2) + std::pow(step_u_phase(*b), 2);
    const double angular = 2.0 * std::numbers::pi * a->frequency_hz;
    weights += angular * angular / variance;
    sum += angular * turned / variance;
  }
  if (!(weights > 0.0)) {
    return not_possible(kind, subject, "they have no step in common");
  }
  const double later_s = -sum / weights, u_s = 1.0 / std::sqrt(weights);
  const double limit = half_interval_s(one) + limit_by_chance(1) * u_s;
  return judged(kind, subject, {later_s, u_s, limit, "s"},
                fmt::format("{} is {:.4g} us later than {} (u {:.2g} us){}", other.function.channel,
                            1e6 * later_s, one.function.channel, 1e6 * u_s,
                            std::abs(later_s) > limit
                                ? ": axes of one sensor are of one sample, so one of them was "
                                  "read late or stands in another's row"
                                : ""));
}

} // namespace dyncal::inline evaluation
