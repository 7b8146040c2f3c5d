#include "analysis/uncertainty/budget.hpp"

#include <cmath>
#include <utility>

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

void Budget::add(Contribution row) {
  if (row.u_magnitude_rel > 0.0 || row.u_phase_rad > 0.0) {
    rows_.push_back(std::move(row));
  }
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
