// How likely the deviations of repeated measurements are, if the repetitions of a whole sweep
// scatter together, as when the sensor is mounted anew between sweeps.
//
//   y_fr = mu_f + g_f (c_r + d_fr) + e_fr     c_r ~ N(0, tau_c^2), the same at all frequencies f
//                                             d_fr ~ N(0, tau_d^2), e_fr ~ N(0, u_f^2)
//
// Repetition r of one frequency belongs to the same sweep as repetition r of the others. However
// many frequencies there are, n sweeps tell tau_c with n - 1 degrees of freedom. With
// D_f = u_f^2 + (g_f tau_d)^2, a = sum(g_f^2 / D_f) and w_r = sum(g_f (y_fr - mean_f) / D_f) the
// logarithm of the likelihood exceeds that of independent frequencies by
//
//   1/2 [tau_c^2 / (1 + a tau_c^2) sum(w_r^2) - (n - 1) log(1 + a tau_c^2)]
//
// which is exact where all repetitions of a frequency have the same noise. Frequencies that lack a
// repetition of the others are left out here. Any thread.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/uncertainty/random_effects.hpp"
#include "analysis/uncertainty/scatter_grid.hpp"

namespace dyncal::analysis {

// At one tau_d, for all tau_c of the grid.
class SweepScatter {
public:
  // `noise` and `unit` (g) of each frequency; `takes_part` tells which of them count.
  SweepScatter(std::span<const RepeatedQuantity> quantities, std::span<const double> noise,
               std::span<const double> unit, const std::vector<bool>& takes_part, double tau_d);

  [[nodiscard]] bool has(std::size_t frequency) const { return !parts_[frequency].empty(); }

  // The terms above, of all frequencies or without one of them.
  [[nodiscard]] const ScatterGrid& log_excess() const { return log_excess_; }
  [[nodiscard]] ScatterGrid log_excess_without(std::size_t frequency) const;

  // No less than the largest of log_excess_without(frequency), which is dear.
  [[nodiscard]] double most_without(std::size_t frequency) const;

private:
  struct Sums { // a and sum(w_r^2)
    double loading = 0.0;
    double squares = 0.0;
  };
  [[nodiscard]] Sums sums_without(std::size_t frequency) const;
  [[nodiscard]] ScatterGrid log_excess_of(const Sums& sums) const;

  std::vector<double> loadings_;           // of each frequency, 0 where it does not count
  std::vector<std::vector<double>> parts_; // of each frequency, of each repetition
  double loading_ = 0.0;                   // a
  std::vector<double> sums_;               // w_r
  ScatterGrid log_excess_{};
};

// Which frequencies have the same repetitions, two or more, as most others; empty when fewer than
// two do.
[[nodiscard]] std::optional<std::vector<bool>>
frequencies_in_sweeps(std::span<const RepeatedQuantity> quantities);

} // namespace dyncal::analysis
