#include "analysis/uncertainty/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Cholesky>

namespace dyncal::analysis {
namespace {

constexpr std::size_t batch = 10'000;

class Draws {
public:
  static Expected<Draws> prepare(std::span<const InputQuantity> inputs,
                                 std::span<const InputCorrelation> correlations,
                                 std::uint64_t seed) {
    Draws draws;
    draws.inputs_.assign(inputs.begin(), inputs.end());
    draws.random_.seed(seed);
    DYNCAL_TRY(propagate_uncertainty(inputs, correlations));
    const auto n = static_cast<Eigen::Index>(inputs.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n);
    for (const InputCorrelation& correlation : correlations) {
      for (const std::size_t i : {correlation.first, correlation.second}) {
        if (inputs[i].distribution != Distribution::normal) {
          return fail(ErrorCode::invalid_argument,
                      inputs[i].name + ": only normal inputs can be drawn with a correlation");
        }
      }
      const auto i = static_cast<Eigen::Index>(correlation.first),
                 j = static_cast<Eigen::Index>(correlation.second);
      matrix(i, j) = matrix(j, i) = correlation.coefficient;
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
    if (factor.info() != Eigen::Success) {
      return fail(ErrorCode::invalid_argument,
                  "the correlation matrix of the inputs is not positive definite");
    }
    draws.factor_ = factor.matrixL();
    draws.normal_draws_.resize(n);
    draws.values_.resize(inputs.size());
    return draws;
  }

  std::span<const double> next() {
    for (Eigen::Index i = 0; i < normal_draws_.size(); ++i) {
      normal_draws_(i) = normal_(random_);
    }
    const Eigen::VectorXd correlated = factor_.triangularView<Eigen::Lower>() * normal_draws_;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      values_[i] = inputs_[i].value +
                   inputs_[i].u * deviate(inputs_[i], correlated(static_cast<Eigen::Index>(i)));
    }
    return values_;
  }

private:
  // Of zero mean; of unit standard deviation but for Student's t.
  double deviate(const InputQuantity& input, double normal) {
    switch (input.distribution) {
    case Distribution::normal:
      if (std::isinf(input.degrees_of_freedom)) {
        return normal;
      }
      return normal /
             std::sqrt(std::chi_squared_distribution<double>(input.degrees_of_freedom)(random_) /
                       input.degrees_of_freedom);
    case Distribution::rectangular:
      return std::sqrt(3.0) * (2.0 * uniform_(random_) - 1.0);
    case Distribution::triangular:
      return std::sqrt(6.0) * (uniform_(random_) + uniform_(random_) - 1.0);
    case Distribution::arcsine:
      return std::sqrt(2.0) * std::sin(2.0 * std::numbers::pi * uniform_(random_));
    }
    return normal;
  }

  std::vector<InputQuantity> inputs_;
  Eigen::MatrixXd factor_;
  Eigen::VectorXd normal_draws_;
  std::vector<double> values_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

struct Summary {
  double mean = 0.0, u = 0.0, low = 0.0, high = 0.0;
};

Summary summarise(std::vector<double> trials, double probability) {
  Summary result;
  const double n = static_cast<double>(trials.size());
  for (const double value : trials) {
    result.mean += value / n;
  }
  for (const double value : trials) {
    result.u += (value - result.mean) * (value - result.mean) / (n - 1.0);
  }
  result.u = std::sqrt(result.u);
  std::sort(trials.begin(), trials.end());
  const auto covered = static_cast<std::size_t>(std::lround(probability * n));
  const std::size_t below = (trials.size() - covered) / 2;
  result.low = trials[below];
  result.high = trials[std::min(below + covered, trials.size() - 1)];
  return result;
}

// JCGM 101, 7.9.2: half a unit of the second significant digit of u.
double tolerance(double u) {
  return 0.5 * std::pow(10.0, std::floor(std::log10(u)) - 1.0);
}

bool is_stable(const std::vector<Summary>& batches, double u) {
  if (batches.size() < 2 || !(u > 0.0)) {
    return !(u > 0.0) && batches.size() >= 2;
  }
  const double h = static_cast<double>(batches.size());
  for (const auto member : {&Summary::mean, &Summary::u, &Summary::low, &Summary::high}) {
    double mean = 0.0, squares = 0.0;
    for (const Summary& one : batches) {
      mean += one.*member / h;
    }
    for (const Summary& one : batches) {
      squares += (one.*member - mean) * (one.*member - mean);
    }
    if (2.0 * std::sqrt(squares / (h * (h - 1.0))) > tolerance(u)) {
      return false;
    }
  }
  return true;
}

class Trials { // of one output quantity
public:
  explicit Trials(double probability) : probability_(probability) {}
  void add(double value) { trials_.push_back(value); }
  // After every full batch.
  bool close_batch() {
    batches_.push_back(summarise({trials_.end() - batch, trials_.end()}, probability_));
    double variance = 0.0;
    for (const Summary& one : batches_) {
      variance += one.u * one.u / static_cast<double>(batches_.size());
    }
    stable_ = is_stable(batches_, std::sqrt(variance));
    return stable_;
  }
  [[nodiscard]] MonteCarloResult result() const {
    const Summary all = summarise(trials_, probability_);
    return {all.mean, all.u, all.low, all.high, trials_.size(), stable_};
  }

private:
  double probability_;
  std::vector<double> trials_;
  std::vector<Summary> batches_;
  bool stable_ = false;
};

// One batch of draws; whether every output is stable after it.
Expected<bool> draw_batch(Draws& draws, const MeasurementModel& model,
                          std::vector<Trials>& trials) {
  std::vector<double> values(trials.size());
  for (std::size_t i = 0; i < batch; ++i) {
    model(draws.next(), values);
    for (std::size_t output = 0; output < trials.size(); ++output) {
      if (!std::isfinite(values[output])) {
        return fail(ErrorCode::not_finite,
                    "the measurement model gave no number for a drawn set of inputs");
      }
      trials[output].add(values[output]);
    }
  }
  bool stable = true;
  for (Trials& one : trials) {
    stable = one.close_batch() && stable;
  }
  return stable;
}

} // namespace

Expected<std::vector<MonteCarloResult>>
propagate_distributions(std::span<const InputQuantity> inputs,
                        std::span<const InputCorrelation> correlations, std::size_t outputs,
                        const MeasurementModel& model, const MonteCarloSettings& settings) {
  DYNCAL_TRY(auto draws, Draws::prepare(inputs, correlations, settings.seed));
  std::vector<Trials> trials(outputs, Trials(settings.probability));
  for (std::size_t done = 0; done < std::max(settings.max_trials, batch); done += batch) {
    if (settings.stop.stop_requested()) {
      return fail(ErrorCode::not_converged, "drawing was stopped before its end");
    }
    DYNCAL_TRY(const auto stable, draw_batch(draws, model, trials));
    if (stable) {
      break;
    }
  }
  std::vector<MonteCarloResult> results;
  for (const Trials& one : trials) {
    results.push_back(one.result());
  }
  return results;
}

} // namespace dyncal::analysis
