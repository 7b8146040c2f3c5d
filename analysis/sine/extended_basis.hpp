// Columns of the extended linear model (extended_sine_fit.hpp), made block by block with the vector
// kernel.
//
// Order: sine, cosine, constant, drift powers, harmonics (sine, cosine each), lines (likewise), u
// sine, u cosine. Phases are about the middle of the record, u runs from -1 to 1. No allocation but
// in the constructor; any thread.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_pass.hpp"

namespace dyncal::analysis::kernel {

class SineBasis {
public:
  // Fails: invalid_argument, frequency_out_of_range.
  [[nodiscard]] static Expected<SineBasis> make(const Record& record, const Frequency& frequency,
                                                const ExtendedBasis& basis);

  [[nodiscard]] static std::size_t columns_of(const ExtendedBasis& basis);
  [[nodiscard]] std::size_t columns() const { return columns_; }

  // Frequencies in the order of their columns: fundamental, harmonics, lines; and the column of
  // each one's sine.
  [[nodiscard]] const std::vector<Frequency>& frequencies() const { return frequencies_; }
  [[nodiscard]] std::size_t sine_column(std::size_t line) const {
    return line == 0 ? 0 : 3 + drift_order_ + 2 * (line - 1);
  }
  [[nodiscard]] std::size_t drift_column() const { return 3; }
  [[nodiscard]] std::size_t phasor_drift_column() const {
    return columns_ - 2;
  } // REQUIRES: drifting_phasor

  // Rows first .. first + n of the record, column by column with `block_samples` rows each, zeros
  // behind them up to a multiple of eight. False: stamps do not increase.
  [[nodiscard]] bool fill(std::size_t first, std::size_t n, double* columns) const;

private:
  SineBasis(const Record& record, const ExtendedBasis& basis, std::vector<Frequency> frequencies);
  [[nodiscard]] bool needs_u() const { return drift_order_ > 0 || drifting_phasor_; }
  const Record* record_;
  std::vector<Frequency> frequencies_;
  std::size_t drift_order_;
  bool drifting_phasor_;
  std::size_t columns_;
};

} // namespace dyncal::analysis::kernel
