#include "services/views/report/mean_budget.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "services/evaluation/result/point_identity.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline views {
namespace {

using analysis::Contribution;

// Squares, by name in the order in which the rows come.
struct Rows {
  std::vector<Contribution> rows;
  std::map<std::string, std::size_t> places;

  Contribution& row_like(const Contribution& one) {
    const auto [place, is_new] = places.try_emplace(one.name(), rows.size());
    if (is_new) {
      rows.push_back(one);
      rows.back().u_magnitude_rel = rows.back().u_phase_rad = 0.0;
      rows.back().u_lasting_magnitude_rel = 0.0;
    }
    return rows[place->second];
  }
};

// `size`: the result over the mean, which rows of the mean are relative to.
void add(const Contribution& one, double size, double n, Rows& rows) {
  Contribution& sum = rows.row_like(one);
  const bool is_drawn = one.repeats == analysis::Repeats::anew;
  const double magnitude2 = std::pow(size * one.u_magnitude_rel, 2);
  const double lasting2 =
      is_drawn ? std::min(magnitude2, std::pow(size * one.u_lasting_magnitude_rel, 2)) : magnitude2;
  sum.u_magnitude_rel += (magnitude2 - lasting2) / (n * n) + lasting2 / n;
  sum.u_lasting_magnitude_rel += is_drawn ? lasting2 / n : 0.0;
  sum.u_phase_rad += std::pow(one.u_phase_rad, 2) / (is_drawn ? n * n : n);
  sum.degrees_of_freedom = std::min(sum.degrees_of_freedom, one.degrees_of_freedom);
}

// What is left of the square of `u` without the rows; 0 where that is rounding.
double beyond(double u, const std::vector<Contribution>& rows, double Contribution::*member) {
  constexpr double least_part = 1e-6;
  double left2 = u * u;
  for (const Contribution& row : rows) {
    left2 -= std::pow(row.*member, 2);
  }
  return left2 > least_part * u * u ? std::sqrt(left2) : 0.0;
}

} // namespace

std::vector<Contribution> budget_of_mean(const StoredResult& result, const StoredValue& value) {
  std::vector<const StoredPoint*> repetitions;
  for (const StoredPoint& point : result.points) {
    if (point.valid && mean_identity_of(point) == identity_of(value)) {
      repetitions.push_back(&point);
    }
  }
  Rows rows;
  const auto n = static_cast<double>(repetitions.size());
  for (const StoredPoint* point : repetitions) {
    for (const Contribution& one : point->budget) {
      add(one, point->magnitude / value.magnitude, n, rows);
    }
  }
  for (Contribution& row : rows.rows) {
    row.u_magnitude_rel = std::sqrt(row.u_magnitude_rel);
    row.u_lasting_magnitude_rel = std::sqrt(row.u_lasting_magnitude_rel);
    row.u_phase_rad = std::sqrt(row.u_phase_rad);
    row.degrees_of_freedom *= row.repeats == analysis::Repeats::anew ? n : 1.0;
  }
  Contribution scatter{.subject = "scatter of the repetitions beyond their budgets",
                       .repeats = analysis::Repeats::anew};
  scatter.u_magnitude_rel =
      beyond(value.of_magnitude.u / value.magnitude, rows.rows, &Contribution::u_magnitude_rel);
  scatter.u_phase_rad = beyond(value.of_phase.u, rows.rows, &Contribution::u_phase_rad);
  if (!rows.rows.empty() && (scatter.u_magnitude_rel > 0.0 || scatter.u_phase_rad > 0.0)) {
    rows.rows.push_back(std::move(scatter));
  }
  return rows.rows;
}

} // namespace dyncal::inline views
