// Propagation of distributions by a Monte Carlo method (JCGM 101:2008, chapters 5 to 7): a
// cross-check of the law of propagation, and the better answer for results that are not normal.
//
// Draws: normal inputs jointly with their correlations (Cholesky factor of the correlation matrix),
// the other distributions independently. A finite nu gives Student's t scaled as in JCGM 101,
// 6.4.9: standard deviation u sqrt(nu / (nu - 2)).
//
// Adaptive (7.9): batches of 10 000 trials until twice the standard deviation of mean, u and both
// ends of the interval over the batches is below half a unit of the second significant digit of u,
// for every output, or `max_trials` are done. Generator: 64-bit Mersenne twister from `seed`; the
// same seed gives the same numbers.
//
// Fails: invalid_argument (as law_of_propagation.hpp; correlation of inputs that are not normal;
// correlation matrix not positive definite), not_finite (the model gave no number), not_converged
// (`stop` was requested first). No threads of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/coverage.hpp"
#include "analysis/uncertainty/law_of_propagation.hpp"

namespace dyncal::analysis {

struct MonteCarloSettings {
  std::uint64_t seed = 1;
  std::size_t max_trials = 1'000'000;
  double probability = two_sigma_probability;
  std::stop_token stop{}; // looked at between batches
};

struct MonteCarloResult { // of one output
  double mean = 0.0;
  double u = 0.0;   // standard deviation of the trials
  double low = 0.0; // probabilistically symmetric coverage interval
  double high = 0.0;
  std::size_t trials = 0;
  bool stable = false; // the adaptive criterion was met
};

// Fills the outputs from one drawn set of inputs.
using MeasurementModel =
    std::function<void(std::span<const double> inputs, std::span<double> outputs)>;

// One result for each of `outputs`.
[[nodiscard]] Expected<std::vector<MonteCarloResult>>
propagate_distributions(std::span<const InputQuantity> inputs,
                        std::span<const InputCorrelation> correlations, std::size_t outputs,
                        const MeasurementModel& model, const MonteCarloSettings& settings = {});

} // namespace dyncal::analysis
