#include "analysis/interferometer/decimation_filter.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "analysis/interferometer/kernel/quadrature_kernel.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t largest_stage = 512;

struct Shape {
  std::size_t half_lengths; // half the filter, in new intervals
  double kaiser_beta;
  double relative_cut_off;
};

Shape shape_of(PassBand pass_band) {
  return pass_band == PassBand::flat ? Shape{10, 16.0, 0.4} : Shape{4, 7.0, 0.45};
}

// I_0 by its series.
double modified_bessel(double x) {
  double term = 1.0;
  double sum = 1.0;
  for (int k = 1; term > 1e-17 * sum; ++k) {
    term *= x * x / (4.0 * k * k);
    sum += term;
  }
  return sum;
}

double coefficient_at(const Shape& shape, double intervals) { // from the middle, in new intervals
  const double angle = 2.0 * std::numbers::pi * shape.relative_cut_off * intervals;
  const double low_pass = angle == 0.0 ? 1.0 : std::sin(angle) / angle;
  const double place = intervals / static_cast<double>(shape.half_lengths);
  const double window =
      modified_bessel(shape.kaiser_beta * std::sqrt(std::max(0.0, 1.0 - place * place)));
  return low_pass * window;
}

} // namespace

DecimationFilter::Stage DecimationFilter::stage_of(std::size_t factor, PassBand pass_band) {
  const Shape shape = shape_of(pass_band);
  Stage stage;
  stage.factor = factor;
  const std::size_t middle = shape.half_lengths * factor;
  double sum = 0.0;
  for (std::size_t k = 0; k <= 2 * middle; ++k) {
    const double samples = static_cast<double>(k) - static_cast<double>(middle);
    stage.coefficients.push_back(coefficient_at(shape, samples / static_cast<double>(factor)));
    sum += stage.coefficients.back();
  }
  for (double& coefficient : stage.coefficients) {
    coefficient /= sum;
  }
  return stage;
}

DecimationFilter::DecimationFilter(std::size_t factor, PassBand pass_band) {
  assert(factor >= 1);
  if (factor == 1) {
    return;
  }
  const std::size_t second = (factor + largest_stage - 1) / largest_stage;
  stages_.push_back(stage_of(factor / second, pass_band));
  if (second > 1) {
    stages_.push_back(stage_of(second, pass_band));
  }
}

void DecimationFilter::push_through(Stage& stage, std::span<const double> values,
                                    std::vector<double>& decimated) {
  const std::size_t skipped = std::min(stage.skipped, values.size());
  stage.skipped -= skipped;
  stage.kept.insert(stage.kept.end(), values.begin() + static_cast<std::ptrdiff_t>(skipped),
                    values.end());
  const kernel::QuadratureKernel& best = kernel::best_quadrature_kernel();
  const std::size_t length = stage.coefficients.size();
  std::size_t at = 0;
  for (; at + length <= stage.kept.size(); at += stage.factor) {
    decimated.push_back(best.sum_of_products(stage.coefficients.data(), &stage.kept[at], length));
  }
  const std::size_t used = std::min(at, stage.kept.size());
  stage.skipped += at - used;
  stage.kept.erase(stage.kept.begin(), stage.kept.begin() + static_cast<std::ptrdiff_t>(used));
}

void DecimationFilter::push(std::span<const double> values, std::vector<double>& decimated) {
  if (stages_.empty()) {
    decimated.insert(decimated.end(), values.begin(), values.end());
  } else if (stages_.size() == 1) {
    push_through(stages_[0], values, decimated);
  } else {
    between_.clear();
    push_through(stages_[0], values, between_);
    push_through(stages_[1], between_, decimated);
  }
}

std::size_t DecimationFilter::factor() const {
  std::size_t factor = 1;
  for (const Stage& stage : stages_) {
    factor *= stage.factor;
  }
  return factor;
}

std::size_t DecimationFilter::first_sample() const {
  std::size_t first = 0;
  std::size_t interval = 1;
  for (const Stage& stage : stages_) {
    first += stage.coefficients.size() / 2 * interval;
    interval *= stage.factor;
  }
  return first;
}

double DecimationFilter::gain(double cycles_per_sample) const {
  double gain = 1.0;
  double cycles = cycles_per_sample;
  for (const Stage& stage : stages_) {
    const double middle = static_cast<double>(stage.coefficients.size() / 2);
    double sum = 0.0;
    for (std::size_t k = 0; k < stage.coefficients.size(); ++k) {
      sum += stage.coefficients[k] *
             std::cos(2.0 * std::numbers::pi * cycles * (static_cast<double>(k) - middle));
    }
    gain *= sum;
    cycles *= static_cast<double>(stage.factor);
  }
  return gain;
}

} // namespace dyncal::analysis
