#include "analysis/interferometer/radius_over_phase.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

namespace dyncal::analysis {
namespace {

constexpr std::size_t most_empty_sectors = radius_sectors / 16;
constexpr int harmonic_columns = 1 + 2 * static_cast<int>(radius_orders);

using HarmonicVector = Eigen::Matrix<double, harmonic_columns, 1>;
using HarmonicMatrix = Eigen::Matrix<double, harmonic_columns, harmonic_columns>;

HarmonicVector harmonic_row(std::size_t sector) {
  const double turns = (static_cast<double>(sector) + 0.5) / radius_sectors - 0.5;
  HarmonicVector row;
  row[0] = 1.0;
  for (std::size_t order = 1; order <= radius_orders; ++order) {
    const auto phasor =
        std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(order) * turns);
    const auto column = static_cast<Eigen::Index>(2 * order - 1);
    row[column] = phasor.real();
    row[column + 1] = phasor.imag();
  }
  return row;
}

} // namespace

void RadiusOverPhase::add(const RadiusOverPhase& other) {
  for (std::size_t i = 0; i < sectors_.size(); ++i) {
    sectors_[i].squares += other.sectors_[i].squares;
    sectors_[i].samples += other.sectors_[i].samples;
  }
}

std::optional<double> RadiusOverPhase::radius(std::size_t sector) const {
  const Sector& one = sectors_[sector];
  if (one.samples == 0) {
    return std::nullopt;
  }
  return std::sqrt(one.squares / static_cast<double>(one.samples));
}

std::optional<RadiusHarmonics> RadiusOverPhase::harmonics() const {
  HarmonicMatrix normal = HarmonicMatrix::Zero();
  HarmonicVector right = HarmonicVector::Zero();
  std::size_t empty = 0;
  for (std::size_t sector = 0; sector < sectors_.size(); ++sector) {
    const auto value = radius(sector);
    if (!value) {
      ++empty;
      continue;
    }
    const double weight = static_cast<double>(sectors_[sector].samples);
    const HarmonicVector row = harmonic_row(sector);
    normal += weight * row * row.transpose();
    right += weight * *value * row;
  }
  if (empty > most_empty_sectors) {
    return std::nullopt;
  }
  const HarmonicVector solution = normal.ldlt().solve(right);
  RadiusHarmonics result;
  result.mean = solution[0];
  for (std::size_t order = 1; order <= radius_orders; ++order) {
    const auto column = static_cast<Eigen::Index>(2 * order - 1);
    result.amplitude[order - 1] = std::hypot(solution[column], solution[column + 1]);
  }
  return result;
}

std::vector<double> RadiusOverPhase::deviations() const {
  constexpr std::size_t sectors_per_part = radius_sectors / radius_parts;
  const auto circle = harmonics();
  if (!circle) {
    return {};
  }
  std::vector<double> deviations;
  for (std::size_t part = 0; part < radius_parts; ++part) {
    Sector sum;
    for (std::size_t i = 0; i < sectors_per_part; ++i) { // the first sector begins at half a turn
      const Sector& one =
          sectors_[(part * sectors_per_part + i + radius_sectors / 2) % radius_sectors];
      sum.squares += one.squares;
      sum.samples += one.samples;
    }
    if (sum.samples == 0) {
      return {};
    }
    deviations.push_back(std::sqrt(sum.squares / static_cast<double>(sum.samples)) / circle->mean -
                         1.0);
  }
  return deviations;
}

std::vector<double> deviations_with(const Ellipse& ellipse, const std::vector<double>& measured,
                                    const Ellipse& measured_with) {
  const kernel::QuadratureCorrection before = correction_of(measured_with);
  const kernel::QuadratureCorrection now = correction_of(ellipse);
  std::vector<double> radii;
  double sum = 0.0;
  for (std::size_t part = 0; part < measured.size(); ++part) {
    const double turns = (static_cast<double>(part) + 0.5) / static_cast<double>(measured.size());
    const auto corrected =
        std::polar(measured_with.radius * (1.0 + measured[part]), 2.0 * std::numbers::pi * turns);
    const double u1 = before.p + corrected.real();
    const double u2 =
        before.q + (corrected.imag() - corrected.real() * before.tangent) / before.scale;
    const double x = u1 - now.p;
    radii.push_back(std::hypot(x, (u2 - now.q) * now.scale + x * now.tangent));
    sum += radii.back();
  }
  for (double& radius : radii) {
    radius = radius * static_cast<double>(radii.size()) / sum - 1.0;
  }
  return radii;
}

} // namespace dyncal::analysis
