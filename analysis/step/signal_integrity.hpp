// Is the series of one channel during one step what its sensor felt? End stops, stuck values,
// distortion and residual, as plain numbers, and the judgement of them. Nobody states the noise of
// a channel: what the residual is held against is the noise of its neighbouring samples.
//
//   y = C + P + sum(P_k, k = 2..10) + e     P_k at k f on the true stamps, so that harmonics above
//                                           half the rate are met where sampling folds them to
//   THD = sqrt(sum |P_k|^2) / |P|           residual = standard deviation of e
//
// A stated range that more than 1 % of the values lie beyond, by more than a twentieth of half of
// it, is none (`beyond_range`): only the record's own extremes count. At a limit: values within
// half a resolution of an end of the stated range, where steps are
// below 2 % of the amplitude within one and a half of the upper one, for the highest code of many
// converters is one step below it; and, stated or not, values equal to the record's own extreme
// where the fitted sine goes on, when they are more than steps q and noise explain; without a known
// step, one and a half times what other values repeat. Their parts p of the record shorten the
// amplitude by x^3 / (3 pi), x = pi p, at each end (`clipping_rel`). What is cut off at one and the
// same phase of every period cannot be told from a converter that meets it there while the noise is
// below 0.7 steps: it is left to the distortion, and to rates that do not divide evenly.
//
// Stuck: a run of equal values during which the fitted sine moves by more than two steps, six times
// the noise of neighbouring values and a fiftieth of the amplitude. Of two or three samples it is a
// repeat, when sine and harmonics move by more than two steps, eight times that noise and a tenth
// of the amplitude. Harmonics that sampling folds onto the signal, onto the mean or onto each other
// are left out. Levels are those of the values, `thd` and `clipping_rel` relative.
//
// What costs time is looked at where the range of the values or equal neighbours in blocks of the
// record show that it is needed: the noise of neighbours on 4096 places at most.
//
// Fails as sine_fit.hpp does. Any thread.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_residuals.hpp"
#include "analysis/step/peak_shape.hpp"

namespace dyncal::analysis {

struct SignalExpectation {
  double range_low = -std::numeric_limits<double>::infinity(); // of the sensor, in its unit
  double range_high = std::numeric_limits<double>::infinity();
  double resolution = 0.0; // one step of the converter; 0: none, or far below the noise
};

struct SignalIntegrity {
  std::uint64_t samples = 0;
  double amplitude = 0.0;
  double at_range_part = 0.0;      // of all samples, at an end of the stated range
  bool beyond_range = false;       // values lie so far beyond it that it cannot be the range
  double clipped_part = 0.0;       // at the record's own extremes, beyond what is natural
  double clipping_rel = 0.0;       // how much of the amplitude these take away, about
  std::uint64_t longest_run = 0;   // of equal values, whatever the signal does
  std::uint64_t longest_stuck = 0; // while the signal moves
  double stuck_part = 0.0;         // of all samples, in such runs
  std::uint64_t repeats = 0;       // shorter runs
  std::uint64_t longest_repeat = 0;
  double repeated_beyond_chance_part = 0.0; // of neighbours (held_values.hpp)
  SineShape shape;                          // for a comparison with the reference's
  double thd = 0.0;
  double u_thd = 0.0; // what noise alone gives
  double residual_sd = 0.0;
  double noise_sd = 0.0; // of neighbouring residuals, and at least that of the steps; 0: no noise
};

[[nodiscard]] Expected<SignalIntegrity> measure_integrity(const Frequency& frequency,
                                                          std::span<const std::int64_t> stamps_ns,
                                                          std::span<const double> values,
                                                          const SignalExpectation& expected);

// The same of a channel that was fitted already (sine_residuals.hpp), harmonics 2 to 10 with it.
[[nodiscard]] SignalIntegrity measure_integrity(const Frequency& frequency,
                                                const PlainChannel& channel,
                                                std::span<const std::int64_t> stamps_ns,
                                                std::span<const double> values,
                                                const SignalExpectation& expected);

struct IntegrityThresholds {
  double at_range_part = 5e-4;
  double clipped_part = 2e-3;
  std::uint64_t stuck_run = 4;
  std::uint64_t repeats = 2; // a single one may be chance
  double thd = 0.05;         // ISO 16063-21: up to 5 % for most frequencies
  double thd_in_u = 6.0;     // and this many times what noise gives
  double refused_clipping_rel = 1e-3;
  double refused_stuck_part = 2e-3;
};

struct IntegrityFindings {
  bool over_range = false;
  bool stuck = false;
  bool distorted = false;
  bool refused = false; // the value cannot be saved
  [[nodiscard]] bool any() const { return over_range || stuck || distorted; }
};

[[nodiscard]] IntegrityFindings judge_integrity(const SignalIntegrity& integrity,
                                                const IntegrityThresholds& thresholds = {});

} // namespace dyncal::analysis
