#include "analysis/uncertainty/monte_carlo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Cholesky>

#include "analysis/base/phasor.hpp"

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
    if (const auto checked = propagate_uncertainty(inputs, correlations); !checked) {
      return fail(checked.error());
    }
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

class Gathering { // of one output quantity
public:
  explicit Gathering(double probability) : probability_(probability) {}
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

} // namespace

Expected<MonteCarloResult> propagate_distributions(std::span<const InputQuantity> inputs,
                                                   std::span<const InputCorrelation> correlations,
                                                   const MeasurementModel& model,
                                                   const MonteCarloSettings& settings) {
  auto draws = Draws::prepare(inputs, correlations, settings.seed);
  if (!draws) {
    return fail(draws.error());
  }
  Gathering gathering(settings.probability);
  for (std::size_t done = 0; done < std::max(settings.max_trials, batch); done += batch) {
    for (std::size_t i = 0; i < batch; ++i) {
      const double value = model(draws->next());
      if (!std::isfinite(value)) {
        return fail(ErrorCode::not_finite,
                    "the measurement model gave no number for a drawn set of inputs");
      }
      gathering.add(value);
    }
    if (gathering.close_batch()) {
      break;
    }
  }
  return gathering.result();
}

namespace {

// Inputs of the quotient: A and B of every fit, then relative magnitude and phase of every other
// row.
struct DrawnChain {
  std::vector<InputQuantity> inputs;
  std::vector<InputCorrelation> correlations;

  void add_fit(const SeriesFit& series) {
    const SineFit& fit = series.fit;
    const double u_a = std::sqrt(fit.covariance[0]), u_b = std::sqrt(fit.covariance[3]);
    inputs.push_back({.name = series.series + " sine", .value = fit.sine, .u = u_a});
    inputs.push_back({.name = series.series + " cosine", .value = fit.cosine, .u = u_b});
    if (u_a > 0.0 && u_b > 0.0) {
      correlations.push_back(
          {inputs.size() - 2, inputs.size() - 1, fit.covariance[1] / (u_a * u_b)});
    }
  }
  void add_row(const Contribution& row) {
    inputs.push_back({.name = row.name() + ", magnitude",
                      .u = row.u_magnitude_rel,
                      .distribution = row.distribution});
    inputs.push_back(
        {.name = row.name() + ", phase", .u = row.u_phase_rad, .distribution = row.distribution});
  }
};

bool is_drawn_as_phasor(const Contribution& row) {
  return row.kind == ContributionKind::fit_noise || row.kind == ContributionKind::rice;
}

// Of the sensor, the reference and, if there are, sync in the ACS and in the DAU.
std::complex<double> quotient(std::span<const double> drawn, std::size_t phasors) {
  const auto phasor = [&](std::size_t i) {
    return std::complex<double>(drawn[2 * i], drawn[2 * i + 1]);
  };
  const std::complex<double> h = phasor(0) / phasor(1);
  return phasors == 2 ? h : h * unit_phasor(phasor(2)) / unit_phasor(phasor(3));
}

} // namespace

Expected<MonteCarloTransfer> check_transfer(const TransferPoint& point,
                                            std::span<const SeriesFit> link,
                                            const MonteCarloSettings& settings) {
  if (link.size() != 1 && link.size() != 3) {
    return fail(ErrorCode::invalid_argument, "a reference is needed, and either no sync or two");
  }
  DrawnChain chain;
  chain.add_fit(point.dut);
  for (const SeriesFit& series : link) {
    chain.add_fit(series);
  }
  const std::size_t phasors = 1 + link.size();
  std::vector<double> estimates;
  for (const InputQuantity& input : chain.inputs) {
    estimates.push_back(input.value);
  }
  for (const Contribution& row : point.budget) {
    if (!is_drawn_as_phasor(row)) {
      chain.add_row(row);
    }
  }
  auto draws = Draws::prepare(chain.inputs, chain.correlations, settings.seed);
  if (!draws) {
    return fail(draws.error());
  }

  const std::complex<double> corrections = point.h / quotient(estimates, phasors);
  Gathering magnitude(settings.probability), phase(settings.probability);
  for (std::size_t done = 0; done < std::max(settings.max_trials, batch); done += batch) {
    for (std::size_t i = 0; i < batch; ++i) {
      const std::span<const double> drawn = draws->next();
      std::complex<double> h = quotient(drawn, phasors) * corrections;
      for (std::size_t row = 2 * phasors; row < drawn.size(); row += 2) {
        h *= (1.0 + drawn[row]) * std::polar(1.0, drawn[row + 1]);
      }
      if (!std::isfinite(h.real()) || !std::isfinite(h.imag())) {
        return fail(ErrorCode::not_finite, "a drawn phasor was 0");
      }
      magnitude.add(std::abs(h));
      phase.add(point.phase_rad + wrap_phase(std::arg(h) - point.phase_rad));
    }
    const bool magnitude_stable = magnitude.close_batch();
    if (phase.close_batch() && magnitude_stable) {
      break;
    }
  }
  return MonteCarloTransfer{magnitude.result(), phase.result()};
}

} // namespace dyncal::analysis
