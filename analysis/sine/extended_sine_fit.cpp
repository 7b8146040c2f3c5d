#include "analysis/sine/extended_sine_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <Eigen/Dense>

#include "analysis/sine/extended_basis.hpp"
#include "analysis/sine/pass_progress.hpp"
#include "analysis/sine/sine_pass.hpp"
#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis {
namespace {

using namespace kernel;

constexpr double min_rcond = 1e-10;
constexpr int max_refinements =
    2; // on the residuals; the first solution has the digits that the condition leaves
constexpr int max_reweightings = 200;
constexpr double settled = 1e-12; // change of the parameters against their size

// Normal equations of one channel for the change of its coefficients.
struct System {
  Eigen::MatrixXd normal;
  Eigen::VectorXd right;
  double ee = 0.0; // unweighted
};

// Sums by the kernels, not by Eigen's products, whose order, and with it their last bits, depends
// on the sizes of the processor's caches.
class Fitter {
public:
  Fitter(const Record& record, SineBasis basis, const Progress& progress)
      : record_(record), basis_(std::move(basis)),
        progress_(progress, {.channels = record.channels().size(),
                             .samples = record.size(),
                             .columns = basis_.columns(),
                             .further_passes = max_refinements}),
        design_(basis_.columns() * block_samples), products_(basis_.columns()) {}

  [[nodiscard]] SineBasis& basis() { return basis_; }
  void begin_channel(std::size_t channel) { progress_.begin_channel(channel); }

  // Sums about `coefficients`; weights may be empty. Residuals are stored when asked for.
  Expected<System> pass(std::span<const double> values, const Eigen::VectorXd& coefficients,
                        std::span<const double> weights, std::vector<double>* residuals,
                        bool with_matrix) {
    const auto columns = static_cast<Eigen::Index>(basis_.columns());
    System system{Eigen::MatrixXd::Zero(columns, columns), Eigen::VectorXd::Zero(columns), 0.0};
    std::array<double, block_samples> e;
    for (std::size_t i = 0; i < values.size(); i += block_samples) {
      const std::size_t n = std::min(block_samples, values.size() - i);
      if (!basis_.fill(i, n, design_.data())) {
        return fail(record_.not_increasing());
      }
      double squares = 0.0;
      kernel_.model_residuals(values.data() + i, n, design_.data(), basis_.columns(),
                              coefficients.data(), e.data(), squares);
      system.ee += squares;
      if (residuals) {
        std::copy_n(e.data(), n, residuals->data() + i);
      }
      add_products(weights.empty() ? design_ : weighted(weights.subspan(i, n)), n, e.data(),
                   with_matrix, system);
      progress_.add_samples(n, i + n, with_matrix);
    }
    for (Eigen::Index row = 0; row < columns; ++row) {
      for (Eigen::Index column = 0; column < row; ++column) {
        system.normal(row, column) = system.normal(column, row);
      }
    }
    if (!std::isfinite(system.ee)) {
      return fail(record_.not_finite());
    }
    return system;
  }

private:
  // The columns times the weights of their rows.
  const std::vector<double>& weighted(std::span<const double> weights) {
    weighted_ = design_;
    for (std::size_t k = 0; k < basis_.columns(); ++k) {
      double* const column = weighted_.data() + k * block_samples;
      std::transform(weights.begin(), weights.end(), column, column,
                     [](double w, double x) { return w * x; });
    }
    return weighted_;
  }

  // The upper triangle of the matrix only.
  void add_products(const std::vector<double>& left, std::size_t n, const double* e,
                    bool with_matrix, System& system) {
    const std::size_t columns = basis_.columns();
    kernel_.model_products(e, n, left.data(), columns, products_.data());
    for (std::size_t k = 0; k < columns; ++k) {
      system.right[static_cast<Eigen::Index>(k)] += products_[k];
    }
    for (std::size_t row = 0; with_matrix && row < columns; ++row) {
      kernel_.model_products(left.data() + row * block_samples, n,
                             design_.data() + row * block_samples, columns - row, products_.data());
      for (std::size_t k = row; k < columns; ++k) {
        system.normal(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) +=
            products_[k - row];
      }
    }
  }

  const SineKernel& kernel_ = best_kernel();
  const Record& record_;
  SineBasis basis_;
  PassProgress progress_;
  std::vector<double> design_, weighted_;
  std::vector<double> products_;
};

// Solves with columns scaled to unit length; tells how well they can be told apart.
class ScaledInverse {
public:
  explicit ScaledInverse(const Eigen::MatrixXd& normal)
      : scale_(normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale_.asDiagonal() * normal *
                                                               scale_.asDiagonal());
    rcond_ = eigen.eigenvalues().minCoeff() / eigen.eigenvalues().maxCoeff();
    if (!(rcond_ > min_rcond)) {
      return;
    }
    inverse_ = scale_.asDiagonal() * eigen.eigenvectors() *
               eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose() *
               scale_.asDiagonal();
  }
  [[nodiscard]] bool usable() const { return rcond_ > min_rcond; }
  [[nodiscard]] const Eigen::MatrixXd& matrix() const { return inverse_; }

private:
  Eigen::VectorXd scale_;
  double rcond_ = 0.0;
  Eigen::MatrixXd inverse_;
};

struct ChannelSolution {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd inverse; // of the unweighted normal matrix
  double rss = 0.0;
  double variance = 0.0; // factor of the inverse
  std::uint64_t outliers = 0;
  int iterations = 0;
};

Error indistinct(const Frequency& frequency) {
  return {ErrorCode::ill_conditioned,
          "the parts of the extended model near " + std::to_string(frequency.hz()) +
              " Hz cannot be told apart in this record; leave some out or record longer"};
}

Eigen::VectorXd starting_level(std::size_t columns, double level) {
  Eigen::VectorXd start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns));
  start[2] = level;
  return start;
}

Expected<ChannelSolution> least_squares(Fitter& fitter, const Frequency& frequency,
                                        std::span<const double> values) {
  const std::size_t columns = fitter.basis().columns();
  ChannelSolution result;
  result.coefficients = starting_level(columns, values.front());
  DYNCAL_TRY(const auto first, fitter.pass(values, result.coefficients, {}, nullptr, true));
  const ScaledInverse inverse(first.normal);
  if (!inverse.usable()) {
    return fail(indistinct(frequency));
  }
  result.inverse = inverse.matrix();
  result.coefficients += result.inverse * first.right;
  for (int i = 0; i < max_refinements; ++i) {
    DYNCAL_TRY(const auto again, fitter.pass(values, result.coefficients, {}, nullptr, false));
    const Eigen::VectorXd step = result.inverse * again.right;
    result.coefficients += step;
    result.rss = std::max(0.0, again.ee - step.dot(again.right));
    if (step.norm() < settled * result.coefficients.norm()) {
      break; // what this one lacks is far below rounding
    }
  }
  result.variance =
      result.rss / (static_cast<double>(values.size()) - static_cast<double>(columns));
  return result;
}

double scale_of(const std::vector<double>& residuals, const Eigen::VectorXd& coefficients,
                std::vector<double>& work) {
  std::transform(residuals.begin(), residuals.end(), work.begin(),
                 [](double r) { return std::abs(r); });
  return std::max(robust_scale(work),
                  1e-16 * coefficients.head(3).norm() + 1e-300); // rounding is noise too
}

// Iterates the weights from `result` until the parameters stay.
Expected<void> reweight(Fitter& fitter, const Frequency& frequency, Weighting weighting,
                        std::span<const double> values, ChannelSolution& result) {
  const std::size_t n = values.size();
  std::vector<double> residuals(n), weights(n), work(n);
  auto sums = fitter.pass(values, result.coefficients, {}, &residuals, false);
  DYNCAL_TRY(sums);
  double scale = scale_of(residuals, result.coefficients, work);
  for (int iteration = 0; iteration < max_reweightings; ++iteration) {
    std::transform(residuals.begin(), residuals.end(), weights.begin(),
                   [&](double r) { return robust_weight(weighting, r, scale); });
    sums = fitter.pass(values, result.coefficients, weights, nullptr, true);
    DYNCAL_TRY(sums);
    const ScaledInverse inverse(sums->normal);
    if (!inverse.usable()) {
      return fail(indistinct(frequency));
    }
    const Eigen::VectorXd step = inverse.matrix() * sums->right;
    result.coefficients += step;
    ++result.iterations;
    sums = fitter.pass(values, result.coefficients, {}, &residuals, false);
    DYNCAL_TRY(sums);
    result.rss = sums->ee;
    // Parameters that move by less than a millionth of their uncertainty stay.
    const double uncertainty = scale * std::sqrt(inverse.matrix().diagonal().maxCoeff());
    if (step.norm() < std::max(settled * result.coefficients.norm(), 1e-6 * uncertainty)) {
      double psi_square = 0.0;
      double slope = 0.0;
      result.outliers = 0;
      for (const double r : residuals) {
        const double w = robust_weight(weighting, r, scale);
        psi_square += w * r * w * r;
        slope += robust_slope(weighting, r, scale);
        result.outliers += w < 0.5 ? 1 : 0;
      }
      slope /= static_cast<double>(n);
      result.variance = psi_square /
                        (static_cast<double>(n) - static_cast<double>(fitter.basis().columns())) /
                        (slope * slope);
      return {};
    }
    scale = scale_of(residuals, result.coefficients, work);
  }
  return fail(ErrorCode::not_converged,
              "the robust weights did not settle; more than a few per cent of outliers?");
}

FurtherPhasor further_phasor(const ChannelSolution& solution, std::size_t column, double hz,
                             double turns) {
  const auto i = static_cast<Eigen::Index>(column);
  SineFit turned;
  turned.sine = solution.coefficients[i];
  turned.cosine = solution.coefficients[i + 1];
  turned.covariance = {solution.variance * solution.inverse(i, i),
                       solution.variance * solution.inverse(i, i + 1),
                       0.0,
                       solution.variance * solution.inverse(i + 1, i + 1),
                       0.0,
                       0.0};
  rotate(turned, turns);
  return {hz, turned.sine, turned.cosine, std::sqrt(turned.covariance[0]),
          std::sqrt(turned.covariance[3])};
}

ExtendedFit assemble(const SineBasis& basis, const ExtendedBasis& wanted,
                     const ChannelSolution& solution, std::size_t samples, std::int64_t shift_ns) {
  const auto turns = [&](std::size_t line) {
    return basis.frequencies()[line].reduced_turns(shift_ns);
  };
  ExtendedFit fit;
  SineFit& f = fit.fundamental;
  f.sine = solution.coefficients[0];
  f.cosine = solution.coefficients[1];
  f.offset = solution.coefficients[2];
  f.rss = solution.rss;
  f.samples = samples;
  f.degrees_of_freedom = static_cast<double>(samples) - static_cast<double>(basis.columns());
  std::size_t element = 0;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = row; column < 3; ++column) {
      f.covariance[element++] = solution.variance * solution.inverse(row, column);
    }
  }
  rotate(f, turns(0));
  for (int k = 0; k < wanted.drift_order; ++k) {
    const auto i = static_cast<Eigen::Index>(basis.drift_column()) + k;
    fit.drift.push_back(solution.coefficients[i]);
    fit.u_drift.push_back(std::sqrt(solution.variance * solution.inverse(i, i)));
  }
  for (std::size_t line = 1; line < basis.frequencies().size(); ++line) {
    const FurtherPhasor phasor = further_phasor(solution, basis.sine_column(line),
                                                basis.frequencies()[line].hz(), turns(line));
    (line < static_cast<std::size_t>(wanted.max_harmonic) ? fit.harmonics : fit.lines)
        .push_back(phasor);
  }
  if (wanted.drifting_phasor) {
    fit.phasor_drift = further_phasor(solution, basis.phasor_drift_column(),
                                      basis.frequencies()[0].hz(), turns(0));
  }
  fit.outliers = solution.outliers;
  fit.iterations = solution.iterations;
  return fit;
}

} // namespace

Expected<std::vector<ExtendedFit>>
fit_sine_extended(const Frequency& frequency, const ExtendedBasis& basis, Weighting weighting,
                  std::int64_t phase_origin_ns, std::span<const std::int64_t> stamps_ns,
                  std::span<const std::span<const double>> channels, const Progress& progress) {
  DYNCAL_TRY(const auto record, Record::make(stamps_ns, channels, SineBasis::columns_of(basis)));
  DYNCAL_TRY(auto columns, SineBasis::make(record, frequency, basis));
  std::int64_t shift_ns = 0;
  if (__builtin_sub_overflow(phase_origin_ns, record.origin_ns(), &shift_ns)) {
    return fail(ErrorCode::invalid_argument,
                "the phase origin is more than 292 years away from the record");
  }
  Fitter fitter(record, std::move(columns), progress);
  std::vector<ExtendedFit> fits;
  for (const std::span<const double> values : channels) {
    fitter.begin_channel(fits.size());
    DYNCAL_TRY(auto solution, least_squares(fitter, frequency, values));
    // Tukey's weights have several solutions: they start from Huber's, which has one.
    if (weighting != Weighting::none) {
      DYNCAL_TRY(reweight(fitter, frequency, Weighting::huber, values, solution));
    }
    if (weighting == Weighting::tukey) {
      DYNCAL_TRY(reweight(fitter, frequency, weighting, values, solution));
    }
    fits.push_back(assemble(fitter.basis(), basis, solution, values.size(), shift_ns));
  }
  fitter.begin_channel(fits.size());
  if (std::none_of(fits.begin(), fits.end(),
                   [](const ExtendedFit& fit) { return is_significant(fit.fundamental); })) {
    return fail(ErrorCode::no_excitation,
                "no sine of " + std::to_string(frequency.hz()) +
                    " Hz stands out of the noise in any channel; check frequency and window");
  }
  return fits;
}

} // namespace dyncal::analysis
