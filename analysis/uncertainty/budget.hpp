// An uncertainty budget as it grows: rows of relative magnitude and phase side by side, added in
// squares (GUM 5.1.2).
//
// Rows are uncorrelated; what is correlated is combined into one row first. One thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/uncertainty/contribution.hpp"
#include "analysis/uncertainty/ratio_scatter.hpp"

namespace dyncal::analysis {

class Budget {
public:
  // A row whose uncertainties are both 0 is left out.
  void add(Contribution row);
  // A row of kind `structure`: what scatter along the record shows beyond the expected
  // uncertainties (ratio_scatter.hpp).
  void add_excess(std::string subject, const std::optional<RatioScatter>& scatter,
                  double expected_magnitude_rel, double expected_phase_rad);
  void append(const Budget& other);

  [[nodiscard]] double u_magnitude_rel() const;
  [[nodiscard]] double u_phase_rad() const;
  [[nodiscard]] const std::vector<Contribution>& rows() const { return rows_; }

private:
  std::vector<Contribution> rows_;
};

} // namespace dyncal::analysis
