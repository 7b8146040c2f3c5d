// The inner loops of the interferometer: from pairs of quadrature signals to wrapped phase, the
// sums that an ellipse is fitted from, and the sums of products of a filter, by the widest
// instructions the processor has.
//
//   X = u1 - p,   Y = (u2 - q) scale + X tangent,   phase = atan2(Y, X) / 2 pi in [-0.5, 0.5]
//
// Every variant is the same text (quadrature_kernel_body.hpp) compiled for another width of vector:
// it takes the same operations in the same order, without fused multiply-adds, and keeps eight
// logical lanes where it adds up (sample i in lane i mod 8, the lanes as ((0+1)+(2+3))+((4+5)+
// (6+7))). So the bits do not depend on the instruction set. The phase is within 2e-16 turns of the
// exact one; (0, 0) has the phase 0, what is not finite gives no finite radius.
//
// No state but what the caller passes; any thread.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dyncal::analysis::kernel {

inline constexpr std::size_t quadrature_lanes = 8;

struct QuadratureCorrection {
  double p, q;
  double tangent; // of alpha
  double scale;   // r / cos(alpha)
};

// Sums of x^i y^j, in the order of the exponents (1,0) (0,1) (2,0) (1,1) (0,2) (3,0) (2,1) (1,2)
// (0,3) (4,0) (3,1) (2,2) (1,3) (0,4).
inline constexpr std::size_t quadrature_moments = 14;

template <class Number>
using QuadraturePhase = void (*)(const Number* u1, const Number* u2, std::size_t n,
                                 const QuadratureCorrection& correction, double* turns,
                                 double* radius_squared);

struct QuadratureKernel {
  const char* name;
  QuadraturePhase<std::int16_t> phase_of_int16;
  QuadraturePhase<float> phase_of_float;
  QuadraturePhase<double> phase_of_double;
  // Adds to `sums`. REQUIRES: n a multiple of eight; a sample of zeros adds nothing.
  void (*moments)(const double* x, const double* y, std::size_t n, double* sums);
  // Sum of the squares of the fourth differences that begin at the first n values; reads four more.
  // REQUIRES: n a multiple of eight.
  double (*fourth_difference_squares)(const double* x, std::size_t n);
  double (*sum_of_products)(const double* a, const double* b, std::size_t n);
};

extern const QuadratureKernel baseline_quadrature_kernel;
extern const QuadratureKernel avx2_quadrature_kernel;   // REQUIRES: avx2
extern const QuadratureKernel avx512_quadrature_kernel; // REQUIRES: avx512f and avx512dq

// The fastest one that this processor runs; chosen once.
[[nodiscard]] const QuadratureKernel& best_quadrature_kernel();

// All that this processor runs, slowest first; nullptr ends the list.
[[nodiscard]] const QuadratureKernel* const* supported_quadrature_kernels();

} // namespace dyncal::analysis::kernel
