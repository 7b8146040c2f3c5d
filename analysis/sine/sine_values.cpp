#include "analysis/sine/sine_values.hpp"

#include <algorithm>

#include "analysis/sine/kernel/sine_kernel.hpp"

namespace dyncal::analysis {

void fill_sine_cosine(const Frequency& frequency, std::int64_t origin_ns,
                      std::span<const std::int64_t> stamps_ns, double* sine, double* cosine) {
  const kernel::TimeAxis axis{frequency.turns_per_ns_high(), frequency.turns_per_ns_low(),
                              origin_ns, 0.0};
  kernel::BlockBasis basis;
  for (std::size_t i = 0; i < stamps_ns.size(); i += kernel::block_samples) {
    const std::size_t n = std::min(kernel::block_samples, stamps_ns.size() - i);
    kernel::DesignSums unused;
    kernel::best_kernel().design(stamps_ns.data() + i, n, axis, basis,
                                 unused); // the order of the stamps does not matter here
    std::copy_n(basis.sine, n, sine + i);
    std::copy_n(basis.cosine, n, cosine + i);
  }
}

} // namespace dyncal::analysis
