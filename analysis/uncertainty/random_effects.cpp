#include "analysis/uncertainty/random_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace dyncal::analysis {
namespace {

// The grid of tau, in units of the noise; one more point stands for 0 and all below the first.
constexpr std::size_t grid_steps = 80;
constexpr std::size_t grid_points = grid_steps + 1;
constexpr double grid_low = 0.03;
constexpr double grid_high = 3e4;
constexpr double prior_bend = 0.2;    // prior density 1 / (bend + tau)
constexpr double no_scatter = 0.35;   // probability that nothing scatters, where it can be seen
constexpr double seen_freedom = 5.0;  // degrees of freedom of all frequencies from which it can
constexpr double unlike_others = 0.1; // probability that a frequency scatters as no other
constexpr double negligible = 1e-7;   // weight of a part
constexpr double bin = 0.04;          // parts whose variances are closer become one

// How far tau differs between frequencies: five points of a log-normal distribution.
struct Likeness {
  double factor, weight;
};
const std::array<Likeness, 5>& likeness() {
  static const std::array<Likeness, 5> points = [] {
    constexpr double spread = 0.3;
    std::array<Likeness, 5> result{};
    constexpr std::array places{-1.6, -0.8, 0.0, 0.8, 1.6};
    constexpr std::array weights{0.11, 0.24, 0.30, 0.24, 0.11};
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i] = {std::exp(spread * places[i]), weights[i]};
    }
    return result;
  }();
  return points;
}

using Grid = std::array<double, grid_points>;

const Grid& grid() {
  static const Grid points = [] {
    Grid result{};
    for (std::size_t i = 0; i < grid_steps; ++i) {
      result[i] = grid_low * std::pow(grid_high / grid_low,
                                      (static_cast<double>(i) + 0.5) / double{grid_steps});
    }
    return result;
  }();
  return points;
}

const Grid& prior() {
  static const Grid weights = [] {
    Grid result{};
    const double step = std::log(grid_high / grid_low) / double{grid_steps};
    for (std::size_t i = 0; i < grid_steps; ++i) {
      result[i] = step * grid()[i] / (prior_bend + grid()[i]);
    }
    result[grid_steps] = std::log1p(grid_low / prior_bend);
    const double total = std::accumulate(result.begin(), result.end(), 0.0);
    for (double& weight : result) {
      weight /= total;
    }
    return result;
  }();
  return weights;
}

// Of the common value: with room for no scatter at all where the frequencies together can tell.
Grid common_prior(double freedom) {
  Grid result = prior();
  if (freedom >= seen_freedom) {
    for (double& weight : result) {
      weight *= 1.0 - no_scatter;
    }
    result[grid_steps] += no_scatter;
  }
  return result;
}

double noise_of(const RepeatedQuantity& quantity) {
  const double squares =
      std::inner_product(quantity.u.begin(), quantity.u.end(), quantity.u.begin(), 0.0);
  return std::sqrt(squares / static_cast<double>(quantity.u.size()));
}

bool shows_scatter(const RepeatedQuantity& quantity) {
  return quantity.u.size() > 1 && noise_of(quantity) > 0.0;
}

// Logarithm of the restricted likelihood: that of the contrasts, which do not depend on the mean.
double log_likelihood(const RepeatedQuantity& quantity, double tau) {
  const double least =
      1e-6 * std::pow(noise_of(quantity), 2); // a run without noise is one of little
  double weights = 0.0, weighted = 0.0, squares = 0.0, logarithms = 0.0;
  for (std::size_t i = 0; i < quantity.u.size(); ++i) {
    const double variance = std::max(least, quantity.u[i] * quantity.u[i]) + tau * tau;
    const double value = quantity.deviations[i];
    weights += 1.0 / variance;
    weighted += value / variance;
    squares += value * value / variance;
    logarithms += std::log(variance);
  }
  return -0.5 * (logarithms + std::log(weights) + squares - weighted * weighted / weights);
}

double variance_of_mean(const RepeatedQuantity& quantity, double tau) {
  const double noise = noise_of(quantity);
  return (noise * noise + tau * tau) / static_cast<double>(quantity.u.size());
}

// What tau is the same in at all frequencies, and how large one of it is at each of them.
struct Hypothesis {
  std::vector<double> unit;       // tau of a frequency is its unit times the common value
  std::vector<Grid> log_evidence; // of each frequency for the common value
  Grid log_sum{};                 // of all of them
};

double log_of_sum(std::span<const double> logarithms, std::span<const double> weights) {
  const double largest = *std::max_element(logarithms.begin(), logarithms.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < logarithms.size(); ++i) {
    sum += weights[i] * std::exp(logarithms[i] - largest);
  }
  return largest + std::log(sum);
}

// The likelihood of a frequency that has nothing to do with the others.
double log_alone(const RepeatedQuantity& quantity) {
  Grid terms{};
  const double noise = noise_of(quantity);
  for (std::size_t i = 0; i < grid_points; ++i) {
    terms[i] = log_likelihood(quantity, grid()[i] * noise);
  }
  return log_of_sum(terms, prior());
}

Hypothesis evaluate(std::span<const RepeatedQuantity> quantities, std::vector<double> unit) {
  Hypothesis result{std::move(unit), std::vector<Grid>(quantities.size(), Grid{}), {}};
  std::array<double, 6> weights{};
  for (std::size_t j = 0; j < likeness().size(); ++j) {
    weights[j] = (1.0 - unlike_others) * likeness()[j].weight;
  }
  weights.back() = unlike_others;
  for (std::size_t f = 0; f < quantities.size(); ++f) {
    if (!shows_scatter(quantities[f])) {
      continue;
    }
    std::array<double, 6> terms{};
    terms.back() = log_alone(quantities[f]);
    for (std::size_t i = 0; i < grid_points; ++i) {
      for (std::size_t j = 0; j < likeness().size(); ++j) {
        terms[j] = log_likelihood(quantities[f], grid()[i] * result.unit[f] * likeness()[j].factor);
      }
      result.log_evidence[f][i] = log_of_sum(terms, weights);
      result.log_sum[i] += result.log_evidence[f][i];
    }
  }
  return result;
}

// Units of one hypothesis, scaled so that their typical size is that of the noise.
std::vector<double> scaled(std::span<const RepeatedQuantity> quantities, std::vector<double> unit) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t f = 0; f < quantities.size(); ++f) {
    if (shows_scatter(quantities[f])) {
      sum += std::log(noise_of(quantities[f]) / unit[f]);
      count += 1.0;
    }
  }
  const double scale = std::exp(sum / std::max(1.0, count));
  for (double& one : unit) {
    one *= scale;
  }
  return unit;
}

std::vector<Hypothesis> hypotheses_of(std::span<const RepeatedQuantity> quantities) {
  std::vector<double> noise, frequency;
  for (const RepeatedQuantity& quantity : quantities) {
    noise.push_back(noise_of(quantity));
    frequency.push_back(quantity.frequency_hz);
  }
  std::vector<Hypothesis> result{evaluate(quantities, noise)};
  if (quantities.size() > 1) {
    result.push_back(
        evaluate(quantities, scaled(quantities, std::vector<double>(quantities.size(), 1.0))));
    if (std::all_of(frequency.begin(), frequency.end(), [](double hz) { return hz > 0.0; })) {
      result.push_back(evaluate(quantities, scaled(quantities, frequency)));
    }
  }
  return result;
}

struct LogPart {
  double variance, log_weight;
};

MeanError mixture(std::vector<LogPart> parts) {
  std::sort(parts.begin(), parts.end(),
            [](const LogPart& a, const LogPart& b) { return a.variance < b.variance; });
  double largest = parts.front().log_weight;
  for (const LogPart& part : parts) {
    largest = std::max(largest, part.log_weight);
  }
  MeanError result;
  double total = 0.0;
  double first = 0.0; // variance of the first in the present bin
  for (const LogPart& part : parts) {
    const double weight = std::exp(part.log_weight - largest);
    if (weight < negligible) {
      continue;
    }
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

double freedom_of(std::span<const RepeatedQuantity> quantities) {
  double freedom = 0.0;
  for (const RepeatedQuantity& quantity : quantities) {
    freedom += static_cast<double>(quantity.u.size()) - 1.0;
  }
  return quantities.size() > 1 ? freedom : 0.0;
}

// Of the frequency `f`, by its own runs and by what the others say of tau.
MeanError error_of_mean(std::span<const RepeatedQuantity> quantities,
                        const std::vector<Hypothesis>& hypotheses, std::size_t f) {
  const RepeatedQuantity& own = quantities[f];
  const bool repeated = shows_scatter(own);
  const Grid common = common_prior(freedom_of(quantities));
  double largest = -1e300;
  for (const Hypothesis& hypothesis : hypotheses) {
    for (std::size_t i = 0; i < grid_points; ++i) {
      largest = std::max(largest, hypothesis.log_sum[i] - hypothesis.log_evidence[f][i]);
    }
  }
  double total = 0.0;
  for (const Hypothesis& hypothesis : hypotheses) {
    for (std::size_t i = 0; i < grid_points; ++i) {
      total +=
          common[i] * std::exp(hypothesis.log_sum[i] - hypothesis.log_evidence[f][i] - largest);
    }
  }
  std::vector<LogPart> parts;
  const auto add = [&](double tau, double log_prior) {
    parts.push_back(
        {variance_of_mean(own, tau), log_prior + (repeated ? log_likelihood(own, tau) : 0.0)});
  };
  const double shared = repeated ? 1.0 - unlike_others : 1.0;
  for (const Hypothesis& hypothesis : hypotheses) {
    for (std::size_t i = 0; i < grid_points; ++i) {
      const double log_prior = std::log(shared * common[i] / total) + hypothesis.log_sum[i] -
                               hypothesis.log_evidence[f][i] - largest;
      if (log_prior < std::log(negligible)) {
        continue;
      }
      for (const Likeness& like : likeness()) {
        add(grid()[i] * hypothesis.unit[f] * like.factor, log_prior + std::log(like.weight));
      }
    }
  }
  for (std::size_t i = 0; repeated && i < grid_points; ++i) {
    add(grid()[i] * noise_of(own), std::log(unlike_others * prior()[i]));
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
  const std::vector<Hypothesis> hypotheses =
      any ? hypotheses_of(with_noise) : std::vector<Hypothesis>{};
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
