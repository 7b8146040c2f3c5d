// An uncertainty budget as it grows: rows of relative magnitude and phase side by side, added in
// squares (GUM 5.1.2).
//
// Rows are uncorrelated; what is correlated is combined into one row first. One thread.
#pragma once

#include <vector>

#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

class Budget {
public:
  // A row whose uncertainties are both 0 is left out.
  void add(Contribution row);
  void append(const Budget& other);

  [[nodiscard]] double u_magnitude_rel() const;
  [[nodiscard]] double u_phase_rad() const;
  [[nodiscard]] const std::vector<Contribution>& rows() const { return rows_; }

private:
  std::vector<Contribution> rows_;
};

} // namespace dyncal::analysis
