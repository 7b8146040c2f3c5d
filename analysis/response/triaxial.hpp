// Three axes: the 3x3 complex response of a sensor at one frequency, and transverse sensitivity.
//
// Columns are excitations, rows axes. Excitation j moves the base by R[:,j] (phasors of the
// triaxial reference) and the sensor answers P[:,j] = H R[:,j]. Errors of all phasors are
// independent:
//
//   H         = P R^-1, with more than three excitations P R^+ (least squares)
//   u^2(H_ij) = sum_k |R^-1_kj|^2 (u^2(P_ik) + sum_l |H_il|^2 u^2(R_lk))   per real component
//
// With a single-axis reference only the column of its axis is known. The transverse ratio |H_ij| /
// |H_jj| then neglects the motion across the axis; a relative bound b of it moves H_ij by up to b
// |H_ii|, taken as rectangular: b |H_ii| / sqrt(3). Phase lead, as everywhere.
//
// Fails: too_few_samples (fewer than three excitations), ill_conditioned (the motions do not span
// three directions: reciprocal condition below 1e-6), invalid_argument. Any thread.
#pragma once

#include <array>
#include <complex>
#include <span>

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

using Axes = std::array<std::complex<double>, 3>;

struct TriaxialExcitation { // one excitation: what reference and sensor said, with u of each real
                            // component
  Axes reference{};
  std::array<double, 3> u_reference{};
  Axes sensor{};
  std::array<double, 3> u_sensor{};
};

struct TriaxialResponse {
  std::array<Axes, 3> h{};                  // h[i][j]: answer of axis i to motion along j
  std::array<std::array<double, 3>, 3> u{}; // of each real component of h
  double reciprocal_condition = 0.0;        // of the motions
};

[[nodiscard]] Expected<TriaxialResponse>
evaluate_triaxial(std::span<const TriaxialExcitation> excitations);

struct TransverseSensitivity {
  std::array<double, 3> ratio{};   // |H_ij| / |H_jj|, 1 for the excited axis itself
  std::array<double, 3> u_ratio{}; // with the bound of the unknown motion
  double largest = 0.0;            // of the other two axes
};

// `column`: H of the three axes to motion along `axis`; `own_response`: |H_ii| of each axis to its
// own motion as far as it is known (the nominal one is good enough for a bound);
// `transverse_motion_rel`: bound of the motion across the axis.
[[nodiscard]] Expected<TransverseSensitivity>
transverse_sensitivity(const Axes& column, const std::array<double, 3>& u_column, std::size_t axis,
                       const std::array<double, 3>& own_response, double transverse_motion_rel);

} // namespace dyncal::analysis
