#include "analysis/sine/extended_basis.hpp"

#include <algorithm>

namespace dyncal::analysis::kernel {
namespace {

constexpr int max_harmonics = 100;
constexpr int max_drift = 8;

tl::unexpected<Error> refuse(const char* message) {
  return fail(ErrorCode::invalid_argument, message);
}

} // namespace

std::size_t SineBasis::columns_of(const ExtendedBasis& basis) {
  const auto drift = static_cast<std::size_t>(std::max(0, basis.drift_order));
  const auto harmonics = static_cast<std::size_t>(std::max(1, basis.max_harmonic) - 1);
  return 3 + drift + 2 * (harmonics + basis.lines.size()) + (basis.drifting_phasor ? 2 : 0);
}

Expected<SineBasis> SineBasis::make(const Record& record, const Frequency& frequency,
                                    const ExtendedBasis& basis) {
  if (basis.drift_order < 0 || basis.drift_order > max_drift) {
    return refuse("the order of the drift must be 0 to 8");
  }
  if (basis.max_harmonic < 1 || basis.max_harmonic > max_harmonics) {
    return refuse("the highest harmonic must be 1 to 100");
  }
  std::vector<Frequency> frequencies{frequency};
  for (int h = 2; h <= basis.max_harmonic; ++h) {
    frequencies.push_back(frequency.multiple(h));
  }
  frequencies.insert(frequencies.end(), basis.lines.begin(), basis.lines.end());
  for (const Frequency& one : frequencies) {
    DYNCAL_TRY(record.check_nyquist(one));
  }
  return SineBasis(record, basis, std::move(frequencies));
}

SineBasis::SineBasis(const Record& record, const ExtendedBasis& basis,
                     std::vector<Frequency> frequencies)
    : record_(&record), frequencies_(std::move(frequencies)),
      drift_order_(static_cast<std::size_t>(basis.drift_order)),
      drifting_phasor_(basis.drifting_phasor), columns_(columns_of(basis)) {}

bool SineBasis::fill(std::size_t first, std::size_t n, double* columns) const {
  const SineKernel& kernel = best_kernel();
  const std::int64_t* stamps = record_->stamps().data() + first;
  const auto column = [columns](std::size_t k) { return columns + k * block_samples; };
  const std::size_t padded = (n + lanes - 1) / lanes * lanes;
  BlockBasis block;
  DesignSums sums;
  SlopeSums slope;
  bool increasing = first == 0 || stamps[0] > stamps[-1];
  for (std::size_t line = 0; line < frequencies_.size(); ++line) {
    const TimeAxis axis = record_->axis(frequencies_[line]);
    increasing &= needs_u() ? kernel.design_with_slope(stamps, n, axis, block, sums, slope)
                            : kernel.design(stamps, n, axis, block, sums);
    std::copy_n(block.sine, padded, column(sine_column(line)));
    std::copy_n(block.cosine, padded, column(sine_column(line) + 1));
  }
  std::fill_n(column(2), n, 1.0);
  std::fill_n(column(2) + n, padded - n, 0.0);
  for (std::size_t k = 0; k < drift_order_; ++k) {
    const double* lower = column(k == 0 ? 2 : 2 + k);
    std::transform(lower, lower + padded, block.u, column(3 + k),
                   [](double power, double u) { return power * u; });
  }
  if (drifting_phasor_) {
    for (std::size_t k = 0; k < 2; ++k) {
      std::transform(column(k), column(k) + padded, block.u, column(phasor_drift_column() + k),
                     [](double x, double u) { return x * u; });
    }
  }
  return increasing;
}

} // namespace dyncal::analysis::kernel
