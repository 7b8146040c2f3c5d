// An uncertainty budget as it grows: named rows, relative magnitude and phase side by side, added
// in squares (GUM 5.1.2; rows are uncorrelated, what is correlated is combined into one row first).
// One thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/method/transfer_point.hpp"
#include "analysis/uncertainty/ratio_scatter.hpp"

namespace dyncal::analysis {

class Budget {
public:
  // Left out when both contributions are 0. `degrees_of_freedom` 0: infinite.
  void add(std::string name, std::string distribution, double degrees_of_freedom,
           double u_magnitude_rel, double u_phase_rad);
  // What scatter along the record shows beyond the expected uncertainties (ratio_scatter.hpp).
  void add_excess(const std::string& name, const std::optional<RatioScatter>& scatter,
                  double expected_magnitude_rel, double expected_phase_rad);
  void append(const Budget& other);

  [[nodiscard]] double u_magnitude_rel() const;
  [[nodiscard]] double u_phase_rad() const;
  [[nodiscard]] const std::vector<Contribution>& rows() const { return rows_; }

private:
  std::vector<Contribution> rows_;
};

} // namespace dyncal::analysis
