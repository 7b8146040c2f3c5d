#include "analysis/uncertainty/scatter_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

namespace dyncal::analysis {
namespace {

using Grid = ScatterGrid;

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
  for (std::size_t i = 0; i < scatter_grid_points; ++i) {
    terms[i] = log_likelihood(quantity, scatter_grid()[i] * noise);
  }
  return log_of_sum(terms, scatter_prior());
}

// Of independent frequencies.
void add_evidence(std::span<const RepeatedQuantity> quantities, std::size_t f,
                  ScatterHypothesis& result) {
  std::array<double, 6> weights{};
  for (std::size_t j = 0; j < likeness().size(); ++j) {
    weights[j] = (1.0 - unlike_others) * likeness()[j].weight;
  }
  weights.back() = unlike_others;
  std::array<double, 6> terms{};
  terms.back() = log_alone(quantities[f]);
  for (std::size_t i = 0; i < scatter_grid_points; ++i) {
    for (std::size_t j = 0; j < likeness().size(); ++j) {
      terms[j] =
          log_likelihood(quantities[f], scatter_grid()[i] * result.unit[f] * likeness()[j].factor);
    }
    result.log_evidence[f][i] = log_of_sum(terms, weights);
    result.log_sum[i] += result.log_evidence[f][i];
  }
}

// Of frequencies in sweeps; those that lack a repetition of the others say nothing.
void add_sweeps(std::span<const RepeatedQuantity> quantities, const std::vector<bool>& in_sweeps,
                ScatterHypothesis& result) {
  std::vector<double> noise;
  std::transform(quantities.begin(), quantities.end(), std::back_inserter(noise), noise_of);
  for (std::size_t f = 0; f < quantities.size(); ++f) {
    const double alone =
        shows_scatter(quantities[f]) && !in_sweeps[f] ? log_alone(quantities[f]) : 0.0;
    for (std::size_t j = 0; j < scatter_grid_points; ++j) {
      result.log_steps[f][j] =
          in_sweeps[f] ? log_likelihood(quantities[f], scatter_grid()[j] * result.unit[f]) : alone;
      result.log_steps_sum[j] += result.log_steps[f][j];
    }
  }
  for (const double tau_d : scatter_grid()) {
    result.sweeps.emplace_back(quantities, noise, result.unit, in_sweeps, tau_d);
  }
}

ScatterHypothesis evaluate(std::span<const RepeatedQuantity> quantities, std::vector<double> unit,
                           const std::optional<std::vector<bool>>& in_sweeps) {
  const std::vector<Grid> nothing(quantities.size(), Grid{});
  ScatterHypothesis result{std::move(unit), nothing, {}, nothing, {}, {}};
  for (std::size_t f = 0; f < quantities.size(); ++f) {
    if (shows_scatter(quantities[f])) {
      add_evidence(quantities, f, result);
    }
  }
  if (in_sweeps) {
    add_sweeps(quantities, *in_sweeps, result);
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

} // namespace

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

std::vector<ScatterHypothesis> scatter_hypotheses(std::span<const RepeatedQuantity> quantities) {
  std::vector<double> noise, frequency;
  for (const RepeatedQuantity& quantity : quantities) {
    noise.push_back(noise_of(quantity));
    frequency.push_back(quantity.frequency_hz);
  }
  const auto in_sweeps = frequencies_in_sweeps(quantities);
  std::vector<ScatterHypothesis> result{evaluate(quantities, noise, in_sweeps)};
  if (quantities.size() > 1) {
    const std::vector<double> constant(quantities.size(), 1.0);
    result.push_back(evaluate(quantities, scaled(quantities, constant), in_sweeps));
    if (std::all_of(frequency.begin(), frequency.end(), [](double hz) { return hz > 0.0; })) {
      result.push_back(evaluate(quantities, scaled(quantities, frequency), in_sweeps));
    }
  }
  return result;
}

} // namespace dyncal::analysis
