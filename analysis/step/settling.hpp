// From when on a steady excitation is steady: settling found from the data, not from fixed seconds.
//
// The record is divided into up to 64 blocks of the same whole number of periods (at least eight
// blocks); P_k is the phasor of block k about one instant at the record's frequency (known, or
// refined on this record). The last third is taken as settled: its mean P and the scatter s of its
// blocks (robust, from the median of |P_k - P|). Going backwards, a block belongs to the steady
// part while
//
//   |P_k - P| <= max(4 s, tolerance |P|)
//
// and the steady part begins after the last block that does not. A first-order approach of size a
// and time constant tau is so left out up to tau ln(a / max(4 s / |P|, tolerance)).
//
// Fails as sine_fit.hpp does; too_few_samples (fewer than eight periods), not_converged (less than
// half of the record is steady). Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct SettlingSettings {
  double tolerance_rel = 1e-4;
};

struct Settling {
  std::int64_t begin_ns = 0;       // of the steady part: no sample before it belongs to it
  double settling_s = 0.0;         // from the record's start
  double max_deviation = 0.0;      // |P_k / P - 1| of the blocks left out, 0 when none was
  double steady_scatter_rel = 0.0; // s / |P|
};

[[nodiscard]] Expected<Settling> find_settling(const Frequency& frequency,
                                               std::span<const std::int64_t> stamps_ns,
                                               std::span<const double> values,
                                               const SettlingSettings& settings = {});

} // namespace dyncal::analysis
