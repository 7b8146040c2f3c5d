// Nominal instants of a block of nearly equidistant samples, with sine and cosine there: what the
// fast form of the fit shares between all blocks of a record.
//
// Sample k of a block lies at
//
//   t_k = anchor + offset_k + d_k,   w (t_k - anchor) = phi_k + x_k,   x_k = w d_k
//
// the anchor being the stamp in the middle of the block and offset_k the rounded multiple of the
// usual interval, both integers. Sine and cosine follow from those of phi_k by a polynomial in the
// small x_k of third or fifth order; what is left out is below 5e-16. Whether a block is near
// enough is decided by its integer deviations alone, so the same on every instruction set; within
// the limit stamps increase strictly. No state; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis::kernel {

inline constexpr std::size_t grid_samples = 512;

struct alignas(64) SampleGrid {
  std::int64_t offsets_ns[grid_samples];
  double sine[grid_samples];
  double cosine[grid_samples];
  double scaled_radians_per_ns; // w sqrt(1/2)
  double max_of_third_order_ns; // deviation up to which x^4 / 24 < 5e-16
  double max_ns;                // and x^6 / 720, with the fifth order
};

// The grid of a record from its usual interval; empty when the record is too short for it to be
// worth while or has no such interval.
[[nodiscard]] std::optional<SampleGrid> sample_grid(std::span<const std::int64_t> stamps,
                                                    const Frequency& frequency);

} // namespace dyncal::analysis::kernel
