#include "analysis/response/least_squares.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include <Eigen/QR>
#include <ceres/ceres.h>
#include <glog/logging.h>

#include "analysis/sine/robust_weights.hpp"

namespace dyncal::analysis {
namespace {

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

// Ceres reports searches that it gives up through glog, whatever its options say.
class Silence {
public:
  Silence() {
    const std::lock_guard lock(mutex);
    if (users++ == 0) {
      level_before = FLAGS_minloglevel;
      FLAGS_minloglevel = google::GLOG_FATAL;
    }
  }
  ~Silence() {
    const std::lock_guard lock(mutex);
    if (--users == 0) {
      FLAGS_minloglevel = level_before;
    }
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

private:
  static inline std::mutex mutex;
  static inline int users = 0;
  static inline int level_before = 0;
};

// With a loss every residual is a cost of its own, for the loss belongs to a block; without one a
// single block is faster.
class Rows final : public ceres::CostFunction {
public:
  Rows(const LeastSquaresProblem& problem, std::size_t first, std::size_t count)
      : problem_(problem), first_(first), count_(count) {
    set_num_residuals(static_cast<int>(count));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.start.size()));
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const std::size_t width = problem_.start.size();
    const bool wants_jacobian = jacobians != nullptr && jacobians[0] != nullptr;
    std::vector<double> all_residuals(problem_.residuals);
    std::vector<double> all_jacobian(wants_jacobian ? problem_.residuals * width : 0);
    if (!problem_.evaluate({parameters[0], width}, all_residuals, all_jacobian) ||
        !finite(all_residuals) || !finite(all_jacobian)) {
      return false; // a step to where the model has no value: Ceres takes a shorter one
    }
    std::copy_n(all_residuals.begin() + static_cast<std::ptrdiff_t>(first_), count_, residuals);
    if (wants_jacobian) {
      std::copy_n(all_jacobian.begin() + static_cast<std::ptrdiff_t>(first_ * width),
                  count_ * width, jacobians[0]);
    }
    return true;
  }

private:
  const LeastSquaresProblem& problem_;
  std::size_t first_;
  std::size_t count_;
};

std::unique_ptr<ceres::LossFunction> loss_function(Loss loss) {
  switch (loss) {
  case Loss::none:
    return nullptr;
  case Loss::huber:
    return std::make_unique<ceres::HuberLoss>(1.345);
  case Loss::tukey:
    return std::make_unique<ceres::TukeyLoss>(4.685);
  }
  return nullptr;
}

void add_residuals(ceres::Problem& problem, const LeastSquaresProblem& description,
                   double* parameters) {
  if (description.loss == Loss::none) {
    problem.AddResidualBlock(new Rows(description, 0, description.residuals), nullptr, parameters);
    return;
  }
  for (std::size_t i = 0; i < description.residuals; ++i) {
    problem.AddResidualBlock(new Rows(description, i, 1), loss_function(description.loss).release(),
                             parameters);
  }
}

struct Strategy {
  ceres::TrustRegionStrategyType type;
  double initial_radius;
  bool scaled; // Marquardt's damping by the columns of the Jacobian, or Levenberg's of all
               // parameters alike
};

constexpr std::array strategies{Strategy{ceres::LEVENBERG_MARQUARDT, 1e4, true},
                                Strategy{ceres::LEVENBERG_MARQUARDT, 1e-3, false},
                                Strategy{ceres::DOGLEG, 1.0, true}};

ceres::Solver::Options solver_options(const Strategy& strategy) {
  ceres::Solver::Options options;
  options.trust_region_strategy_type = strategy.type;
  options.initial_trust_region_radius = strategy.initial_radius;
  if (!strategy.scaled) {
    options.jacobi_scaling = false;
    options.min_lm_diagonal = options.max_lm_diagonal = 1.0;
  }
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 2000;
  options.function_tolerance = 1e-18;
  options.gradient_tolerance = 1e-30;
  options.parameter_tolerance = 1e-15;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

// Near enough for Gauss-Newton steps, or given up.
ceres::Solver::Options quick_options(const Strategy& strategy) {
  ceres::Solver::Options options = solver_options(strategy);
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-8;
  options.parameter_tolerance = 1e-8;
  return options;
}

Expected<LeastSquaresSolution> search(const LeastSquaresProblem& description) {
  Expected<LeastSquaresSolution> best = fail(ErrorCode::not_converged, "the model was not fitted");
  double lowest = std::numeric_limits<double>::infinity();
  const Silence silence;
  for (const Strategy& strategy : strategies) {
    LeastSquaresSolution solution;
    solution.parameters = description.start;
    ceres::Problem problem;
    add_residuals(problem, description, solution.parameters.data());
    ceres::Solver::Summary summary;
    const bool quick = description.search == Search::quick;
    ceres::Solve(quick ? quick_options(strategy) : solver_options(strategy), &problem, &summary);
    if (quick ? !summary.IsSolutionUsable() : summary.termination_type != ceres::CONVERGENCE) {
      if (!best) {
        best = fail(ErrorCode::not_converged, "the model was not fitted: " + summary.message);
      }
      continue;
    }
    if (!(summary.final_cost < lowest)) {
      continue;
    }
    lowest = summary.final_cost;
    solution.iterations = static_cast<int>(summary.iterations.size());
    best = std::move(solution);
    if (quick) {
      break;
    }
  }
  return best;
}

Weighting weighting_of(Loss loss) {
  switch (loss) {
  case Loss::none:
    return Weighting::none;
  case Loss::huber:
    return Weighting::huber;
  case Loss::tukey:
    return Weighting::tukey;
  }
  return Weighting::none;
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The problem about one point: residuals, Jacobian, and the QR of the weighted Jacobian with
// columns of unit length.
class Linearised {
public:
  static Expected<Linearised> at(const LeastSquaresProblem& problem,
                                 const std::vector<double>& parameters) {
    const auto n = static_cast<Eigen::Index>(problem.residuals),
               p = static_cast<Eigen::Index>(parameters.size());
    std::vector<double> residuals(problem.residuals),
        jacobian(problem.residuals * parameters.size());
    if (!problem.evaluate(parameters, residuals, jacobian) || !finite(residuals) ||
        !finite(jacobian)) {
      return fail(ErrorCode::not_finite, "the model has no value near the end of the search");
    }
    Linearised result;
    result.residuals_ = Eigen::Map<Eigen::VectorXd>(residuals.data(), n);
    result.jacobian_ = Eigen::Map<RowMajor>(jacobian.data(), n, p);
    result.weighting_ = weighting_of(problem.loss);
    result.root_weights_ = result.residuals_.unaryExpr([&](double residual) {
      return std::sqrt(robust_weight(result.weighting_, residual, 1.0));
    });
    result.scale_ = result.jacobian_.colwise().norm().transpose();
    if (!(result.scale_.minCoeff() > 0.0)) {
      return undetermined();
    }
    result.weighted_.compute(result.root_weights_.asDiagonal() * result.jacobian_ *
                             result.scale_.cwiseInverse().asDiagonal());
    const auto diagonal = result.weighted_.matrixR().diagonal().cwiseAbs();
    if (!(diagonal(p - 1) > 1e-12 * diagonal(0))) {
      return undetermined();
    }
    return result;
  }

  [[nodiscard]] Eigen::VectorXd step() const {
    return -scale_.cwiseInverse().cwiseProduct(
        weighted_.solve(root_weights_.cwiseProduct(residuals_)));
  }

  // (J'J)^-1 times the variance of the residuals.
  [[nodiscard]] Eigen::MatrixXd covariance(ResidualVariance variance) const {
    const Eigen::Index p = jacobian_.cols();
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> plain(jacobian_ *
                                                            scale_.cwiseInverse().asDiagonal());
    const Eigen::MatrixXd inverse_r =
        plain.matrixR().topRows(p).triangularView<Eigen::Upper>().solve(
            Eigen::MatrixXd::Identity(p, p));
    const Eigen::MatrixXd root =
        scale_.cwiseInverse().asDiagonal() * (plain.colsPermutation() * inverse_r);
    return variance_factor(variance) * root * root.transpose();
  }

  [[nodiscard]] double rss() const { return residuals_.squaredNorm(); }

private:
  static tl::unexpected<Error> undetermined() {
    return fail(ErrorCode::ill_conditioned,
                "the measured values do not determine all parameters of the model");
  }

  [[nodiscard]] double variance_factor(ResidualVariance variance) const {
    const double n = static_cast<double>(jacobian_.rows()),
                 freedom = n - static_cast<double>(jacobian_.cols());
    if (weighting_ == Weighting::none) {
      return variance == ResidualVariance::known ? 1.0 : rss() / freedom;
    }
    double squares = 0.0, slopes = 0.0;
    for (const double residual : residuals_) {
      squares += std::pow(robust_weight(weighting_, residual, 1.0) * residual, 2);
      slopes += robust_slope(weighting_, residual, 1.0);
    }
    return squares / freedom / std::pow(slopes / n, 2);
  }

  Eigen::VectorXd residuals_;
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd root_weights_;
  Eigen::VectorXd scale_;
  Weighting weighting_ = Weighting::none;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> weighted_;
};

// Gauss-Newton steps as long as they become shorter.
Expected<Linearised> polish(const LeastSquaresProblem& problem, std::vector<double>& parameters) {
  constexpr int max_steps = 50;
  auto here = Linearised::at(problem, parameters);
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; here && i < max_steps; ++i) {
    const Eigen::VectorXd step = here->step();
    double size = 0.0;
    std::vector<double> next(parameters);
    for (std::size_t k = 0; k < next.size(); ++k) {
      next[k] += step(static_cast<Eigen::Index>(k));
      size = std::max(size, std::abs(step(static_cast<Eigen::Index>(k))) /
                                std::max(std::abs(next[k]), 1e-300));
    }
    if (!(size < before)) {
      break;
    }
    auto there = Linearised::at(problem, next);
    if (!there || (problem.loss == Loss::none && there->rss() > here->rss() * (1.0 + 1e-9))) {
      break;
    }
    parameters = std::move(next);
    here = std::move(there);
    before = size;
    if (size < 1e-15) {
      break;
    }
  }
  return here;
}

} // namespace

double LeastSquaresSolution::u(std::size_t parameter) const {
  return std::sqrt(covariance_of(parameter, parameter));
}

Expected<LeastSquaresSolution> solve_least_squares(const LeastSquaresProblem& problem) {
  const std::size_t n = problem.residuals, p = problem.start.size();
  const bool needs_scatter =
      problem.variance == ResidualVariance::estimated || problem.loss != Loss::none;
  if (p == 0 || n < p || (needs_scatter && n == p)) {
    return fail(ErrorCode::too_few_samples, "a model needs more values than it has parameters");
  }
  std::vector<double> residuals(n);
  if (!problem.evaluate(problem.start, residuals, {}) || !finite(residuals)) {
    return fail(ErrorCode::not_finite, "the model has no value at the start of the search");
  }

  auto solution = search(problem);
  if (!solution) {
    return solution;
  }
  DYNCAL_TRY(const auto minimum, polish(problem, solution->parameters));
  const RowMajor covariance = minimum.covariance(problem.variance);
  solution->covariance.assign(covariance.data(), covariance.data() + covariance.size());
  solution->rss = minimum.rss();
  solution->degrees_of_freedom = static_cast<double>(n - p);
  return solution;
}

} // namespace dyncal::analysis
