#include "services/evaluation/closures/repetition_closures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>

#include <fmt/core.h>

#include "analysis/base/statistics.hpp"
#include "services/evaluation/closures/mountings.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/evaluation/result/point_identity.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double prior_freedom = 3.0;
// Of the standard deviation's degrees of freedom, as many has a median.
constexpr double efficiency_of_median = 0.37;
// Of a normal deviate's absolute value.
constexpr double median_of_absolute = 0.6745;
constexpr std::size_t least_comparisons = 4; // for a median that one of them does not move
constexpr double repeatability = 5e-3;       // of a sensor that nobody touched; part, and rad
constexpr double least_u = 1e-12;            // of what no noise is stated for

struct Difference { // of one repetition from another
  double magnitude_rel = 0.0;
  double phase_rad = 0.0;
  double u_magnitude_rel = 1.0;
  double u_phase_rad = 1.0;
};

std::complex<double> log_ratio(const analysis::Repetition& one, const analysis::Repetition& other) {
  return std::log(one.h / other.h);
}

// A value without noise is known to the rounding of its fit; one of no length has no ratio.
Difference difference(const analysis::Repetition& one, const analysis::Repetition& other) {
  if (!(std::abs(one.h) > 0.0 && std::abs(other.h) > 0.0)) {
    return {one.h == other.h ? 0.0 : std::numeric_limits<double>::infinity()};
  }
  const std::complex<double> d = log_ratio(one, other);
  return {std::abs(d.real()), std::abs(d.imag()),
          std::max(least_u, std::hypot(one.u_random_magnitude_rel, other.u_random_magnitude_rel)),
          std::max(least_u, std::hypot(one.u_random_phase_rad, other.u_random_phase_rad))};
}

// By how much repetitions differ: so many times what single results state, and so much beyond it.
struct Usual {
  double magnitude = 1.0;
  double phase = 1.0;
  double beyond = 0.0;
  double degrees_of_freedom = analysis::infinite_degrees_of_freedom; // of how many times

  [[nodiscard]] double magnitude_of(const Difference& one, double limit) const {
    return one.magnitude_rel / (magnitude * one.u_magnitude_rel + beyond / limit);
  }
  [[nodiscard]] double phase_of(const Difference& one, double limit) const {
    return one.phase_rad / (phase * one.u_phase_rad + beyond / limit);
  }
  [[nodiscard]] double larger_of(const Difference& one, double limit) const {
    return std::max(magnitude_of(one, limit), phase_of(one, limit));
  }
};

// That to which the others are nearest.
std::size_t middle_of(const std::vector<analysis::Repetition>& values) {
  std::size_t middle = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < values.size(); ++i) {
    double sum = 0.0;
    for (const analysis::Repetition& other : values) {
      sum += std::abs(log_ratio(values[i], other));
    }
    if (sum < least) {
      least = sum;
      middle = i;
    }
  }
  return middle;
}

// A repetition against that in the middle of its point.
struct Compared {
  const PointRepetitions* point = nullptr;
  std::size_t repetition = 0;
  std::size_t middle = 0;
  Difference d;
};

std::vector<Compared> compared(const std::vector<PointRepetitions>& points) {
  std::vector<Compared> all;
  for (const PointRepetitions& point : points) {
    const std::size_t middle = middle_of(point.values);
    for (std::size_t i = 0; i < point.values.size(); ++i) {
      if (i != middle) {
        all.push_back({&point, i, middle, difference(point.values[i], point.values[middle])});
      }
    }
  }
  return all;
}

// By the median of all, of a normal deviate 1, at least that. Where nothing tells the mountings
// from the points, what mountings may differ by.
Usual usual(const std::vector<Compared>& all, bool mountings_known) {
  if (!mountings_known) {
    return {.beyond = mounting_tolerance};
  }
  if (all.size() < least_comparisons) {
    return {.beyond = repeatability};
  }
  std::vector<double> magnitudes, phases;
  for (const Compared& one : all) {
    magnitudes.push_back(one.d.magnitude_rel / one.d.u_magnitude_rel);
    phases.push_back(one.d.phase_rad / one.d.u_phase_rad);
  }
  return {.magnitude = std::max(1.0, analysis::median(magnitudes) / median_of_absolute),
          .phase = std::max(1.0, analysis::median(phases) / median_of_absolute),
          .degrees_of_freedom =
              prior_freedom + efficiency_of_median * static_cast<double>(all.size())};
}

std::string what_is_off(const ChannelRun& run, const Compared& one) {
  const std::complex<double> d =
      log_ratio(one.point->values[one.repetition], one.point->values[one.middle]);
  const StepResult& result = *one.point->results[one.repetition];
  return fmt::format("at {} repetition {} has {:.4g} times the magnitude of repetition {} and "
                     "is turned by {:.3g} degrees against it",
                     run.place_of(result), result.repetition, std::exp(d.real()),
                     one.point->results[one.middle]->repetition, degrees_of(d.imag()));
}

void add_off(const PointRepetitions& point, std::size_t repetition, std::size_t middle,
             RepetitionClosures& result) {
  result.off.push_back(point.results[repetition]);
  if (point.results.size() == 2) { // nobody knows which of the two
    result.off.push_back(point.results[middle]);
  }
}

// All of a repetition at another level than the others: open, with all of its results.
bool add_mounting_that_is_off(const ChannelRun& run, const Mountings& mountings,
                              RepetitionClosures& result) {
  const auto farthest = mountings.farthest();
  const std::uint32_t repetition = farthest.first;
  const Mounting& mounting = farthest.second;
  const double limit = mounting_tolerance + limit_by_chance(1) * mounting.u_magnitude_rel;
  if (std::abs(mounting.magnitude_log) <= limit) {
    return false;
  }
  result.closures.push_back(
      judged(ClosureKind::repetitions, fmt::format("repetition {}", repetition),
             {mounting.magnitude_log, mounting.u_magnitude_rel, limit, "1"},
             fmt::format("all of repetition {} has {:.4g} times the magnitude of the others: look "
                         "at how the sensor was mounted, at ranges and supplies, and measure it "
                         "again",
                         repetition, std::exp(mounting.magnitude_log))));
  std::copy_if(run.results.begin(), run.results.end(), std::back_inserter(result.off),
               [&](const StepResult* one) { return one->repetition == repetition; });
  return true;
}

void add_agreement(const ChannelRun& run, const Mountings& mountings,
                   const std::vector<Compared>& all, RepetitionClosures& result) {
  if (all.empty()) {
    result.closures.push_back(
        not_possible(ClosureKind::repetitions, "", "no point was measured more than once"));
    return;
  }
  const Usual s = usual(all, mountings.are_known());
  const double limit = limit_by_chance(2 * all.size(), s.degrees_of_freedom);
  const Compared* worst = &all.front();
  double largest = 0.0;
  for (const Compared& one : all) {
    const double z = s.larger_of(one.d, limit);
    if (z > limit) {
      add_off(*one.point, one.repetition, one.middle, result);
    }
    if (z > largest) {
      largest = z;
      worst = &one;
    }
  }
  if (!(largest > limit) && add_mounting_that_is_off(run, mountings, result)) {
    return;
  }
  result.closures.push_back(
      judged(ClosureKind::repetitions, run.place_of(*worst->point->results.front()),
             {largest, 1.0, limit, "1"},
             fmt::format("{}{}", what_is_off(run, *worst),
                         largest > limit
                             ? fmt::format(", {:.3g} times what repetitions usually differ by: "
                                           "look at how the sensor was mounted, at cables "
                                           "and at ranges, and measure it again",
                                           largest)
                             : "")));
}

struct Excess {
  double chi_squared = 0.0; // against the u of the means
  double stated = 0.0;      // against what single results state
  double freedom = 0.0;

  void add(double n, double scatter, double u_mean, double u_single) {
    if (u_mean > 0.0 && u_single > 0.0) {
      chi_squared += (n - 1.0) * scatter * scatter / (n * u_mean * u_mean);
      stated += (n - 1.0) * scatter * scatter / (u_single * u_single);
      freedom += n - 1.0;
    }
  }
};

double usual_u(const PointRepetitions& point, double analysis::Repetition::*u) {
  double squares = 0.0;
  for (const analysis::Repetition& one : point.values) {
    squares += (one.*u) * (one.*u) / static_cast<double>(point.values.size());
  }
  return std::sqrt(squares);
}

Closure scatter(const ChannelRun& run, const std::vector<PointRepetitions>& points) {
  Excess magnitude, phase;
  for (const PointRepetitions& point : points) {
    const auto mean = std::find_if(
        run.function.points.begin(), run.function.points.end(), [&](const FrequencyPoint& one) {
          return identity_of(run.function, one) == mean_identity_of(*point.results.front());
        });
    if (mean == run.function.points.end() || point.values.size() < 2) {
      continue;
    }
    const double n = static_cast<double>(point.values.size());
    magnitude.add(n, mean->mean.scatter_magnitude / mean->mean.magnitude,
                  mean->mean.independent_magnitude_rel.u,
                  usual_u(point, &analysis::Repetition::u_random_magnitude_rel));
    phase.add(n, mean->mean.scatter_phase_rad, mean->mean.independent_phase.u,
              usual_u(point, &analysis::Repetition::u_random_phase_rad));
  }
  if (!(magnitude.freedom + phase.freedom > 0.0)) {
    return not_possible(ClosureKind::repetition_scatter, "",
                        "no point was measured more than once");
  }
  const auto of = [](const Excess& one, double sum) {
    return one.freedom > 0.0 ? std::sqrt(sum / one.freedom) : 0.0;
  };
  const bool by_phase = of(phase, phase.chi_squared) > of(magnitude, magnitude.chi_squared);
  const Excess& worse = by_phase ? phase : magnitude;
  const double limit = std::sqrt(chi_squared_by_chance(2, worse.freedom));
  const double value = of(worse, worse.chi_squared);
  return judged(ClosureKind::repetition_scatter, by_phase ? "phase" : "magnitude",
                {value, 0.0, limit, "1"},
                fmt::format("repetitions scatter {:.3g} times what single results state, and "
                            "{:.3g} times what the u of their means has{}",
                            of(worse, worse.stated), value,
                            value > limit ? ": their means are known worse than is stated" : ""));
}

Closure first_again(const ChannelRun& run, const Mountings& mountings,
                    const std::vector<Compared>& all) {
  const RecipeStep& planned_first = run.recipe.steps.front();
  const RecipeStep& planned_last = run.recipe.steps.back();
  const bool planned = run.recipe.steps.size() > 2 &&
                       planned_first.frequency_text_hz == planned_last.frequency_text_hz &&
                       planned_first.level_m_s2 == planned_last.level_m_s2;
  const StepResult& first = *run.results.front();
  const StepResult& last = *run.results.back();
  if (!planned || first.step != planned_first.step || last.step != planned_last.step) {
    return not_possible(ClosureKind::first_repeated, "",
                        planned ? "the first or the last step has no value"
                                : "the plan does not end with its first point (repeat_first)");
  }
  const analysis::Repetition before = mountings.value_of(first);
  const analysis::Repetition behind = mountings.value_of(last);
  const std::complex<double> d = log_ratio(behind, before);
  const Difference off = difference(behind, before);
  const Usual s = usual(all, mountings.are_known());
  const double chance_limit = limit_by_chance(2, s.degrees_of_freedom);
  const bool by_phase = s.phase_of(off, chance_limit) > s.magnitude_of(off, chance_limit);
  const double u = by_phase ? s.phase * off.u_phase_rad : s.magnitude * off.u_magnitude_rel;
  const double value = by_phase ? d.imag() : d.real();
  const double limit = chance_limit * u + s.beyond;
  return judged(
      ClosureKind::first_repeated, run.place_of(first), {value, u, limit, by_phase ? "rad" : "1"},
      fmt::format("from the first step to the last, {} Hz both, the {} changed by {:.3g}{}",
                  first.frequency_text_hz, by_phase ? "phase in rad" : "magnitude's part", value,
                  std::abs(value) > limit ? ": the sensor, its mounting or the reference drifts"
                                          : ""));
}

} // namespace

RepetitionClosures repetition_closures(const ChannelRun& run) {
  if (!run.moves()) {
    const std::string why = "the channel hardly follows the excitation";
    return {{not_possible(ClosureKind::repetitions, "", why),
             not_possible(ClosureKind::repetition_scatter, "", why),
             not_possible(ClosureKind::first_repeated, "", why)},
            {}};
  }
  const Mountings mountings(run);
  const std::vector<PointRepetitions> points = mountings.points(run);
  const std::vector<Compared> all = compared(points);
  RepetitionClosures result;
  add_agreement(run, mountings, all, result);
  result.closures.push_back(scatter(run, points));
  result.closures.push_back(first_again(run, mountings, all));
  return result;
}

} // namespace dyncal::inline evaluation
