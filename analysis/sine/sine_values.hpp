// Sine and cosine of a frequency at any instants, by the vector kernel: about 1 ns a sample.
//
//   sine[i] = sin(w (stamps[i] - origin)),   cosine[i] likewise
//
// The error is below 3e-16 for |stamps[i] - origin| < 2^51 ns (26 days), which is REQUIRED. Stamps
// in any order. No allocation; any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

// REQUIRES: as much room as there are stamps.
void fill_sine_cosine(const Frequency& frequency, std::int64_t origin_ns,
                      std::span<const std::int64_t> stamps_ns, double* sine, double* cosine);

} // namespace dyncal::analysis
