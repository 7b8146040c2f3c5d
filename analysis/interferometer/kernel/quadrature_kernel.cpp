#include "analysis/interferometer/kernel/quadrature_kernel.hpp"

namespace dyncal::analysis::kernel {
namespace {

struct QuadratureChoice {
  const QuadratureKernel* supported[4] = {&baseline_quadrature_kernel, nullptr, nullptr, nullptr};
  std::size_t count = 1;

  QuadratureChoice() {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
      supported[count++] = &avx2_quadrature_kernel;
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
      supported[count++] = &avx512_quadrature_kernel;
    }
#endif
  }
};

const QuadratureChoice& quadrature_choice() {
  static const QuadratureChoice chosen;
  return chosen;
}

} // namespace

const QuadratureKernel& best_quadrature_kernel() {
  return *quadrature_choice().supported[quadrature_choice().count - 1];
}

const QuadratureKernel* const* supported_quadrature_kernels() {
  return quadrature_choice().supported;
}

} // namespace dyncal::analysis::kernel
