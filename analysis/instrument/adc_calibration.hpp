// The response of the DAU's sync ADC at a frequency, from the points at which it was calibrated.
//
//   G(f) = g0 e^{-i w tau} / (1 + i f / fc),   phase_lag_rad = -arg G, positive: the ADC reads late
//   u^2  = (w1 u1 + w2 u2)^2 + e^2 / 3
//
// G is approximated to the points (1 / g^2 is linear in f^2; the rest of the lag, unwrapped, is
// w tau); the ratio of points and model is interpolated, log gain and phase each
// (curve_between_points.hpp, with e as what a straight line misses). A pure delay and a first-order
// low pass are therefore exact. The first term of u holds however much the two points have in
// common (time scales, voltmeter), and is an upper bound where they have nothing. Points of
// different test amplitudes are never mixed: gains differ by per cents, delays by a factor.
//
// Fails: invalid_argument (no points, not positive, several test amplitudes and none chosen),
// out_of_calibration (frequency outside the calibrated range, or no points within a factor of two
// of the test amplitude): nothing is extrapolated. Any thread.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

struct AdcResponse { // of the DAU's sync ADC at one frequency
  double gain = 1.0;
  double phase_lag_rad = 0.0;
  double u_gain = 0.0;
  double u_phase_lag_rad = 0.0;
};

struct AdcCalibrationPoint {
  double frequency_hz = 0.0;
  double test_amplitude_vpp = 0.0;
  double gain = 1.0;
  double phase_lag_rad = 0.0;
  double u_gain = 0.0;
  double u_phase_lag_rad = 0.0;
};

// `points` in any order. Without a test amplitude all points must have the same; with one the
// nearest (in ratio) is used.
[[nodiscard]] Expected<AdcResponse>
adc_response_at(std::span<const AdcCalibrationPoint> points, double frequency_hz,
                std::optional<double> test_amplitude_vpp = std::nullopt);

// Makes points from repeated or single measurements: the mean of those at the same frequency and
// amplitude, u from their scatter, pooled over four frequencies on either side; where nothing was
// repeated, from how far these points lie from the line through their neighbours (median). The u_
// fields of measurements are what repeating does not show, because repetitions have it in common;
// the largest of a frequency is added (in squares). Ordered by amplitude, then frequency.
[[nodiscard]] std::vector<AdcCalibrationPoint>
adc_calibration_points(std::span<const AdcCalibrationPoint> measurements);

} // namespace dyncal::analysis
