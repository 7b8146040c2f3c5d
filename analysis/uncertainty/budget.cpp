#include "analysis/uncertainty/budget.hpp"

#include <cmath>

namespace dyncal::analysis {
namespace {

double root_of_squares(const std::vector<Contribution>& rows, double Contribution::*member) {
  double sum = 0.0;
  for (const Contribution& row : rows) {
    sum += row.*member * (row.*member);
  }
  return std::sqrt(sum);
}

} // namespace

void Budget::add(std::string name, std::string distribution, double degrees_of_freedom,
                 double u_magnitude_rel, double u_phase_rad) {
  if (u_magnitude_rel > 0.0 || u_phase_rad > 0.0) {
    rows_.push_back({std::move(name), std::move(distribution), degrees_of_freedom, u_magnitude_rel,
                     u_phase_rad});
  }
}

void Budget::add_excess(const std::string& name, const std::optional<RatioScatter>& scatter,
                        double expected_magnitude_rel, double expected_phase_rad) {
  if (!scatter) {
    return;
  }
  const double freedom = scatter->degrees_of_freedom;
  add(name, "normal", freedom,
      significant_excess(scatter->u_magnitude_rel, expected_magnitude_rel, freedom),
      significant_excess(scatter->u_phase_rad, expected_phase_rad, freedom));
}

void Budget::append(const Budget& other) {
  rows_.insert(rows_.end(), other.rows_.begin(), other.rows_.end());
}

double Budget::u_magnitude_rel() const {
  return root_of_squares(rows_, &Contribution::u_magnitude_rel);
}

double Budget::u_phase_rad() const {
  return root_of_squares(rows_, &Contribution::u_phase_rad);
}

} // namespace dyncal::analysis
