#include "analysis/uncertainty/random_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace dyncal::analysis {
namespace {

constexpr double one_sigma_probability = 0.68268949213708590;
// The grid of tau, in units of the noise; one more point stands for 0 and all below the first.
constexpr std::size_t grid_steps = 80;
constexpr std::size_t grid_points = grid_steps + 1;
constexpr double grid_low = 0.03;
constexpr double grid_high = 3e4;
constexpr double prior_bend = 0.2;    // prior density 1 / (bend + tau)
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

// Of the frequency `f`, by its own runs and by what the others say of tau.
MeanError error_of_mean(std::span<const RepeatedQuantity> quantities,
                        const std::vector<Hypothesis>& hypotheses, std::size_t f) {
  const RepeatedQuantity& own = quantities[f];
  const bool repeated = shows_scatter(own);
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
          prior()[i] * std::exp(hypothesis.log_sum[i] - hypothesis.log_evidence[f][i] - largest);
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
      const double log_prior = std::log(shared * prior()[i] / total) + hypothesis.log_sum[i] -
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

// Half the interval that holds `probability`.
double half_interval(const MeanError& error, double u_common, double probability) {
  const auto outside = [&](double half) {
    double sum = 0.0;
    for (const MeanError::Part& part : error.parts) {
      sum += part.weight * std::erfc(half / std::sqrt(2.0 * (part.variance + u_common * u_common)));
    }
    return sum;
  };
  double low = 0.0;
  double high = std::hypot(std::sqrt(error.parts.front().variance), u_common);
  while (outside(high) > 1.0 - probability) {
    low = high;
    high *= 2.0;
  }
  for (int i = 0; i < 100 && high - low > 1e-9 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (outside(middle) > 1.0 - probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Degrees of freedom of Student's t by the quotient of its 95.45 % and 68.27 % intervals.
double degrees_of_freedom_of(double quotient) {
  struct Entry {
    double log_freedom, log_excess;
  };
  constexpr double first = -1.0; // logarithm of the degrees of freedom
  constexpr double step = 0.1;
  static const std::array<Entry, 131> table = [] {
    std::array<Entry, 131> entries{};
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const double log_freedom = first + step * static_cast<double>(i);
      const double freedom = std::exp(log_freedom);
      entries[i] = {log_freedom, std::log(coverage_factor(freedom) /
                                              coverage_factor(freedom, one_sigma_probability) -
                                          2.0)};
    }
    return entries;
  }();
  const double log_excess = std::log(std::max(quotient - 2.0, 1e-300));
  if (log_excess <= table.back().log_excess) {
    return infinite_degrees_of_freedom;
  }
  const auto above = std::find_if(table.begin() + 1, table.end() - 1, [&](const Entry& entry) {
    return entry.log_excess <= log_excess;
  });
  const Entry& below = *(above - 1);
  const double part =
      std::max(0.0, (log_excess - below.log_excess) / (above->log_excess - below.log_excess));
  return std::exp(below.log_freedom + part * step);
}

// Of Student's t and a normal part. k(nu_eff) alone (GUM G.4) covers only 93 % with n = 3 and a
// common part of 0.2..0.5 u_a; expanding the parts one by one and adding squares covers up to 98 %.
// A third of the way between: 94.1..96.5 % for n = 3 and any common part.
CombinedUncertainty combine_student(const UncertaintyPart& student, double u_common) {
  const std::array parts{student, UncertaintyPart{u_common}};
  CombinedUncertainty result;
  result.u = std::hypot(student.u, u_common);
  if (!(result.u > 0.0)) {
    return result;
  }
  result.degrees_of_freedom = effective_degrees_of_freedom(parts);
  const double by_effective_freedom = coverage_factor(result.degrees_of_freedom);
  const double by_parts = std::hypot(coverage_factor(student.degrees_of_freedom) * student.u,
                                     coverage_factor(infinite_degrees_of_freedom) * u_common) /
                          result.u;
  result.k = by_effective_freedom + (by_parts - by_effective_freedom) / 3.0;
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

CombinedUncertainty combine(const MeanError& error, double u_common) {
  if (error.parts.empty()) {
    return combine_student(error.student, u_common);
  }
  if (error.parts.size() == 1) {
    return {std::hypot(std::sqrt(error.parts.front().variance), u_common)};
  }
  const double expanded = half_interval(error, u_common, two_sigma_probability);
  CombinedUncertainty result;
  result.degrees_of_freedom =
      degrees_of_freedom_of(expanded / half_interval(error, u_common, one_sigma_probability));
  result.k = coverage_factor(result.degrees_of_freedom);
  result.u = expanded / result.k;
  return result;
}

} // namespace dyncal::analysis
