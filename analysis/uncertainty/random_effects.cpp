#include "analysis/uncertainty/random_effects.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/uncertainty/scatter_grid.hpp"
#include "analysis/uncertainty/scatter_hypotheses.hpp"

namespace dyncal::analysis {
namespace {

using Grid = ScatterGrid;

constexpr double no_scatter = 0.35;     // probability that nothing scatters, where it can be seen
constexpr std::size_t seen_from = 4;    // frequencies; two or three cannot tell (94 % covered)
constexpr double sweeps_scatter = 0.75; // probability that sweeps may scatter as a whole
constexpr double negligible = 1e-7;     // weight of a part
constexpr double out_of_reach = 1e-10;  // against the likeliest: what the others make of a part
constexpr double bin = 0.04;            // parts whose variances are closer become one

Grid with_room_for_none(Grid prior) {
  for (double& weight : prior) {
    weight *= 1.0 - no_scatter;
  }
  prior[scatter_grid_steps] += no_scatter;
  return prior;
}

// Of what single runs add to the scatter of sweeps: with room for nothing, however few frequencies
// there are. Without it sweeps pass for independent runs (n = 2, four frequencies: 92 % covered).
const Grid& steps_prior() {
  static const Grid prior = with_room_for_none(scatter_prior());
  return prior;
}

const Grid& log_sweep_prior() {
  static const Grid logarithms = [] {
    Grid result{};
    std::transform(sweep_scatter_prior().begin(), sweep_scatter_prior().end(), result.begin(),
                   [](double weight) { return std::log(weight); });
    return result;
  }();
  return logarithms;
}

double variance_of_mean(const RepeatedQuantity& quantity, double tau) {
  const double noise = noise_of(quantity);
  return (noise * noise + tau * tau) / static_cast<double>(quantity.u.size());
}

struct LogPart {
  double variance, log_weight;
};

MeanError mixture(std::vector<LogPart> parts) {
  double largest = parts.front().log_weight;
  for (const LogPart& part : parts) {
    largest = std::max(largest, part.log_weight);
  }
  std::erase_if(
      parts, [&](const LogPart& part) { return part.log_weight < largest + std::log(negligible); });
  std::sort(parts.begin(), parts.end(),
            [](const LogPart& a, const LogPart& b) { return a.variance < b.variance; });
  MeanError result;
  double total = 0.0;
  double first = 0.0; // variance of the first in the present bin
  for (const LogPart& part : parts) {
    const double weight = std::exp(part.log_weight - largest);
    total += weight;
    if (!result.parts.empty() && part.variance <= (1.0 + bin) * first) {
      MeanError::Part& last = result.parts.back();
      last.variance += (part.variance - last.variance) * weight / (last.weight + weight);
      last.weight += weight;
    } else {
      first = part.variance;
      result.parts.push_back({part.variance, weight});
    }
  }
  for (MeanError::Part& part : result.parts) {
    part.weight /= total;
  }
  return result;
}

std::size_t repeated_frequencies(std::span<const RepeatedQuantity> quantities) {
  return static_cast<std::size_t>(
      std::count_if(quantities.begin(), quantities.end(), shows_scatter));
}

// What the scatter at one frequency may be: how likely the other frequencies make it, and what is
// measured there beside them.
struct Candidate {
  double tau, log_others, log_own;
};

void add_independent(const RepeatedQuantity& own, const ScatterHypothesis& hypothesis,
                     std::size_t f, const Grid& prior, std::vector<Candidate>& candidates) {
  const double probability = hypothesis.sweeps.empty() ? 1.0 : 1.0 - sweeps_scatter;
  for (std::size_t i = 0; i < scatter_grid_points; ++i) {
    const double log_others =
        std::log(probability * prior[i]) + hypothesis.log_sum[i] - hypothesis.log_evidence[f][i];
    for (const Likeness& like : likeness()) {
      const double tau = scatter_grid()[i] * hypothesis.unit[f] * like.factor;
      candidates.push_back({tau, log_others + std::log(like.weight),
                            shows_scatter(own) ? log_likelihood(own, tau) : 0.0});
    }
  }
}

// What the other frequencies and the prior make of each tau_d, at most over all tau_c.
Grid most_of_sweeps(const ScatterHypothesis& hypothesis, std::size_t f) {
  Grid result{};
  for (std::size_t j = 0; j < scatter_grid_points; ++j) {
    result[j] = std::log(sweeps_scatter * steps_prior()[j]) + hypothesis.log_steps_sum[j] -
                hypothesis.log_steps[f][j] + hypothesis.sweeps[j].most_without(f);
  }
  return result;
}

void add_sweeps(const RepeatedQuantity& own, const ScatterHypothesis& hypothesis, std::size_t f,
                std::vector<Candidate>& candidates) {
  if (hypothesis.sweeps.empty()) {
    return;
  }
  const Grid most = most_of_sweeps(hypothesis, f);
  const double least = *std::max_element(most.begin(), most.end()) + std::log(out_of_reach);
  for (std::size_t j = 0; j < scatter_grid_points; ++j) {
    if (most[j] < least) {
      continue;
    }
    const SweepScatter& sweeps = hypothesis.sweeps[j];
    const Grid& all = sweeps.log_excess();
    const Grid others = sweeps.log_excess_without(f);
    const double log_prior = most[j] - sweeps.most_without(f);
    for (std::size_t i = 0; i < scatter_grid_points; ++i) {
      const double log_others = log_prior + log_sweep_prior()[i] + others[i];
      if (log_others < least) {
        continue;
      }
      const double tau = hypothesis.unit[f] * std::hypot(scatter_grid()[i], scatter_grid()[j]);
      double log_own = hypothesis.log_steps[f][j] + all[i] - others[i];
      if (!sweeps.has(f)) {
        log_own = shows_scatter(own) ? log_likelihood(own, tau) : 0.0;
      }
      candidates.push_back({tau, log_others, log_own});
    }
  }
}

// Of the frequency `f`, by its own runs and by what the others say of tau.
MeanError error_of_mean(std::span<const RepeatedQuantity> quantities,
                        const std::vector<ScatterHypothesis>& hypotheses, std::size_t f) {
  const RepeatedQuantity& own = quantities[f];
  const bool repeated = shows_scatter(own);
  const bool are_few = repeated_frequencies(quantities) < seen_from;
  const Grid alone = are_few ? scatter_prior_of_few(own.u.size()) : scatter_prior();
  const Grid prior = are_few ? alone : with_room_for_none(alone);
  std::vector<Candidate> candidates;
  for (const ScatterHypothesis& hypothesis : hypotheses) {
    add_independent(own, hypothesis, f, prior, candidates);
    add_sweeps(own, hypothesis, f, candidates);
  }
  double largest = -1e300;
  for (const Candidate& candidate : candidates) {
    largest = std::max(largest, candidate.log_others);
  }
  double total = 0.0;
  for (const Candidate& candidate : candidates) {
    total += std::exp(candidate.log_others - largest);
  }
  std::vector<LogPart> parts;
  const double log_total = largest + std::log(total / (repeated ? 1.0 - unlike_others : 1.0));
  for (const Candidate& candidate : candidates) {
    if (const double log_prior = candidate.log_others - log_total;
        log_prior > std::log(negligible)) {
      parts.push_back({variance_of_mean(own, candidate.tau), log_prior + candidate.log_own});
    }
  }
  for (std::size_t i = 0; repeated && i < scatter_grid_points; ++i) {
    const double tau = scatter_grid()[i] * noise_of(own);
    parts.push_back({variance_of_mean(own, tau),
                     std::log(unlike_others * alone[i]) + log_likelihood(own, tau)});
  }
  return mixture(std::move(parts));
}

MeanError student_error(const RepeatedQuantity& quantity) {
  const double n = static_cast<double>(quantity.deviations.size());
  const double middle =
      std::accumulate(quantity.deviations.begin(), quantity.deviations.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : quantity.deviations) {
    squares += (value - middle) * (value - middle);
  }
  MeanError result;
  if (n > 1.0) {
    result.student = {std::sqrt(squares / (n - 1.0) / n), n - 1.0};
  }
  return result;
}

} // namespace

std::vector<MeanError> errors_of_means(std::span<const RepeatedQuantity> at_frequencies) {
  std::vector<MeanError> result;
  const bool any = std::any_of(at_frequencies.begin(), at_frequencies.end(), shows_scatter);
  std::vector<RepeatedQuantity> with_noise;
  for (const RepeatedQuantity& quantity : at_frequencies) {
    if (noise_of(quantity) > 0.0) {
      with_noise.push_back(quantity);
    }
  }
  const std::vector<ScatterHypothesis> hypotheses =
      any ? scatter_hypotheses(with_noise) : std::vector<ScatterHypothesis>{};
  std::size_t next = 0;
  for (const RepeatedQuantity& quantity : at_frequencies) {
    if (!(noise_of(quantity) > 0.0)) {
      result.push_back(student_error(quantity));
    } else if (!any) {
      result.push_back({{{variance_of_mean(quantity, 0.0), 1.0}}, {}});
    } else {
      result.push_back(error_of_mean(with_noise, hypotheses, next++));
    }
  }
  return result;
}

} // namespace dyncal::analysis
