#include "analysis/sine/kernel/sine_kernel.hpp"

namespace dyncal::analysis::kernel {
namespace {

struct Choice {
  const SineKernel* supported[4] = {&baseline_kernel, nullptr, nullptr, nullptr};
  std::size_t count = 1;

  Choice() {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
      supported[count++] = &avx2_kernel;
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
      supported[count++] = &avx512_kernel;
    }
#endif
  }
};

const Choice& choice() {
  static const Choice chosen;
  return chosen;
}

} // namespace

const SineKernel& best_kernel() {
  return *choice().supported[choice().count - 1];
}

const SineKernel* const* supported_kernels() {
  return choice().supported;
}

} // namespace dyncal::analysis::kernel
