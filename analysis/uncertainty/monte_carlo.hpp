// Propagation of distributions by a Monte Carlo method (JCGM 101:2008, chapters 5 to 7): a
// cross-check of the law of propagation, and the better answer near |H| = 0, for A/u below 5 and
// for results that are not normal.
//
// Draws: normal inputs jointly with their correlations (Cholesky factor of the correlation matrix),
// a finite nu gives Student's t scaled as in JCGM 101, 6.4.9 (standard deviation u sqrt(nu / (nu -
// 2))), the other distributions independently. Adaptive (7.9): batches of 10 000 trials until twice
// the standard deviation of mean, u and both ends of the interval over the batches is below half a
// unit of the second significant digit of u, or `max_trials` are done. Generator: 64-bit Mersenne
// twister from `seed`; the same seed gives the same numbers. Phases are taken about the evaluated
// one, so an interval across +-pi is whole. Fails: invalid_argument (as uncertainty.hpp;
// correlation of inputs that are not normal; correlation matrix not positive definite), not_finite
// (the model gave no number). No threads of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/method/transfer_point.hpp"
#include "analysis/uncertainty/coverage.hpp"
#include "analysis/uncertainty/law_of_propagation.hpp"

namespace dyncal::analysis {

struct MonteCarloSettings {
  std::uint64_t seed = 1;
  std::size_t max_trials = 1'000'000;
  double probability = two_sigma_probability;
};

struct MonteCarloResult {
  double mean = 0.0;
  double u = 0.0;   // standard deviation of the trials
  double low = 0.0; // probabilistically symmetric coverage interval
  double high = 0.0;
  std::size_t trials = 0;
  bool stable = false; // the adaptive criterion was met
};

using MeasurementModel = std::function<double(std::span<const double> inputs)>;

[[nodiscard]] Expected<MonteCarloResult>
propagate_distributions(std::span<const InputQuantity> inputs,
                        std::span<const InputCorrelation> correlations,
                        const MeasurementModel& model, const MonteCarloSettings& settings = {});

struct MonteCarloTransfer {
  MonteCarloResult magnitude;
  MonteCarloResult phase_rad;
};

// The transfer function of `point` from drawn phasors: those of the sensor and of `link`, which is
// the reference alone (paper eqs. (1), (2)) or reference, sync in the ACS and sync in the DAU (eqs.
// (3), (4)), with the covariances of their coefficients; every other row of the point's budget as
// it stands there. Corrections are constants: what the point has beside the quotient of its
// phasors. Never resamples raw data. Fails also with invalid_argument (no reference, or only one
// sync).
[[nodiscard]] Expected<MonteCarloTransfer> check_transfer(const TransferPoint& point,
                                                          std::span<const SeriesFit> link,
                                                          const MonteCarloSettings& settings = {});

} // namespace dyncal::analysis
