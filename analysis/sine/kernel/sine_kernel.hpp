// The inner loops of the sine approximation: sums over one block of samples, by the widest
// instructions the processor has.
//
//   x_i = frac((t_i - origin) * (high + low))   phase in turns, by an error-free product
//   s_i = sin(2 pi x_i),  c_i = cos(2 pi x_i),  u_i = (t_i - origin) * inverse_scale
//
// No digit is lost however long the record is. Every variant keeps eight logical lanes (sample i in
// lane i mod 8), uses the fused multiply-add at the same places and adds the lanes up as
// ((0+1)+(2+3))+((4+5)+(6+7)): the bits do not depend on the instruction set. Without fused
// multiply-add in hardware it is composed of exact additions and products (correct for |products|
// in 1e-290..1e290).
//
// Blocks hold at most block_samples. REQUIRES: |t_i - origin| < 2^51 ns (26 days), less than 2^40
// turns. No state but what the caller passes; any thread.
#pragma once

#include <cstddef>
#include <cstdint>

#include "analysis/sine/kernel/sine_grid.hpp"

namespace dyncal::analysis::kernel {

inline constexpr std::size_t lanes = 8;
inline constexpr std::size_t block_samples = 512;

struct TimeAxis {
  double turns_per_ns_high;
  double turns_per_ns_low;
  std::int64_t origin_ns;
  double inverse_scale; // 1/ns
};

// Basis of one block; rows past the last sample up to a multiple of eight are zero.
struct alignas(64) BlockBasis {
  double sine[block_samples];
  double cosine[block_samples];
  double u[block_samples];
};

// Sums over the block. "us" is sum of u_i s_i, "usc" of u_i s_i c_i, and so on.
struct DesignSums {
  double s, c, ss, sc;
};
struct SlopeSums {
  double u, uu, us, uc, uss, usc, uus, uuc, uuss, uusc;
};

struct Parameters {
  double sine, cosine, offset;
};
// Of e_i = y_i - (sine s_i + cosine c_i + offset).
struct ResidualSums {
  double e, es, ec, ee;
};
struct ResidualSlopeSums {
  double eus, euc;
};

// Orders 0..moment_order of u in the block, for series in the frequency.
inline constexpr std::size_t moment_order = 6;
inline constexpr std::size_t moment_count = moment_order + 1;
struct DesignMoments {
  double u[moment_count];
  double us[moment_count], uc[moment_count];   // sum u^m s, u^m c
  double uss[moment_count], usc[moment_count]; // sum u^m s^2, u^m s c
};
struct ResidualMoments {
  double e, ee;
  double us[moment_count], uc[moment_count]; // sum e u^m s, e u^m c
};

// How far before they are summed samples are asked for.
inline constexpr std::size_t fetched_ahead_samples = 1024;

// Sums over blocks of samples near the instants of a grid, one call up to `grid_call_samples`.
inline constexpr std::size_t grid_call_samples = lanes * grid_samples;
inline constexpr std::size_t grid_call_channels = 4;

// How many sums design_with_time(), residuals_with_time() and each order of line_sums() add to.
inline constexpr std::size_t design_time_sums = 6;
inline constexpr std::size_t residual_time_sums = 5;
inline constexpr std::size_t line_design_sums = 4;

struct SineKernel {
  const char* name;
  // The same sums as fit_block's, by sine_grid.hpp: n a multiple of eight, at most
  // grid_call_samples, channels at most grid_call_channels. Takes whole blocks of the grid (the
  // last one may be shorter) as long as their samples are near enough, and returns how many samples
  // these are; stamps within a block then increase, those across are for the caller to compare.
  std::size_t (*fit_on_grid)(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                             const SampleGrid& grid, const double* const* values,
                             std::size_t channels, const Parameters* start, DesignSums& sums,
                             ResidualSums* residual_sums);
  // Likewise with the sums weighted with u.
  std::size_t (*series_on_grid)(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                                const SampleGrid& grid, const double* const* values,
                                std::size_t channels, const Parameters* start, DesignSums& design,
                                SlopeSums& slope, ResidualSums* residuals,
                                ResidualSlopeSums* residual_slopes);
  // Design and residual sums of several channels at once; as design() and residuals() give them,
  // bit for bit.
  bool (*fit_block)(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                    const double* const* values, std::size_t channels, const Parameters* start,
                    DesignSums& sums, ResidualSums* residual_sums);
  // Fills sine and cosine (and u). False when the stamps do not increase strictly within the block.
  bool (*design)(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis, BlockBasis& basis,
                 DesignSums& sums);
  bool (*design_with_slope)(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                            BlockBasis& basis, DesignSums& sums, SlopeSums& slope);
  void (*residuals)(const double* values, std::size_t n, const BlockBasis& basis,
                    const Parameters& start, ResidualSums& sums);
  void (*residuals_with_slope)(const double* values, std::size_t n, const BlockBasis& basis,
                               const Parameters& start, ResidualSums& sums,
                               ResidualSlopeSums& slope);
  // Models of `count` columns, `block_samples` apart; columns are zero past the last row up to a
  // multiple of eight, and so are the residuals that are left: y - sum of coefficient times column,
  // and the sum of their squares.
  void (*model_residuals)(const double* values, std::size_t n, const double* columns,
                          std::size_t count, const double* coefficients, double* residuals,
                          double& squares);
  // Of one column with each of `count` others.
  void (*model_products)(const double* one, std::size_t n, const double* columns, std::size_t count,
                         double* products);

  // The sums of these are added to what is there, eight lanes each. Fills sine, cosine and u; sums
  // of u^1 .. u^6. False when the stamps do not increase strictly within the block.
  bool (*design_with_time)(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                           BlockBasis& basis, double* time_sums);
  // The residuals, zero past the last one up to a multiple of eight; sums of e, e u, e u^2, e u^3
  // and e^2.
  void (*residuals_with_time)(const double* values, std::size_t n, const BlockBasis& basis,
                              const Parameters& start, double* residuals, double* sums);
  // Of `orders` (a multiple of three) multiples of the phase from `first_order` on: the four sums
  // of DesignSums each; e sin and e cos each for every channel.
  void (*line_sums)(const BlockBasis& basis, std::size_t n, std::size_t first_order,
                    std::size_t orders, const double* const* residuals, std::size_t channels,
                    double* design, double* const* sums);
  // The smallest and the largest value; whether any two neighbours are equal.
  bool (*value_range)(const double* values, std::size_t n, double& low, double& high);
};

extern const SineKernel baseline_kernel;
extern const SineKernel avx2_kernel;   // REQUIRES: avx2 and fma
extern const SineKernel avx512_kernel; // REQUIRES: avx512f and avx512dq

// The fastest one that this processor runs; chosen once.
[[nodiscard]] const SineKernel& best_kernel();

// All that this processor runs, slowest first; nullptr ends the list.
[[nodiscard]] const SineKernel* const* supported_kernels();

} // namespace dyncal::analysis::kernel
