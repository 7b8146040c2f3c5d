#include "services/evaluation/shared_phase_uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <string>

namespace dyncal::inline evaluation {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;
using analysis::Repeats;

struct RowOverFrequency {
  bool is_delay = false;
  bool is_of_reference = false;
  std::vector<double> u2_rad2; // of each frequency
};

struct SharedPart { // squares
  double delay_s2 = 0.0;
  double phase_rad2 = 0.0;
};

std::map<std::string, RowOverFrequency>
rows_that_repeat(std::span<const BudgetAtFrequency> frequencies) {
  std::map<std::string, RowOverFrequency> rows;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    for (const Contribution& contribution : frequencies[i].budget) {
      if (contribution.repeats == Repeats::anew || contribution.u_phase_rad <= 0.0) {
        continue;
      }
      RowOverFrequency& row = rows[contribution.name()];
      row.is_delay = contribution.repeats == Repeats::common_delay;
      row.is_of_reference = contribution.kind == ContributionKind::reference;
      row.u2_rad2.resize(frequencies.size(), 0.0);
      row.u2_rad2[i] += contribution.u_phase_rad * contribution.u_phase_rad;
    }
  }
  return rows;
}

double least_ratio(const std::vector<double>& values, const std::vector<double>& over) {
  double least = values.front() / over.front();
  for (std::size_t i = 1; i < values.size(); ++i) {
    least = std::min(least, values[i] / over[i]);
  }
  return least;
}

// The line from the lowest to the highest frequency, with neither part below 0, and lowered until
// it lies nowhere above the row.
SharedPart delay_and_phase(const std::vector<double>& u2, const std::vector<double>& w2) {
  SharedPart part;
  const auto [low, high] = std::minmax_element(w2.begin(), w2.end());
  const auto first = static_cast<std::size_t>(low - w2.begin());
  const auto last = static_cast<std::size_t>(high - w2.begin());
  if (*high > *low) {
    part.delay_s2 = std::max(0.0, (u2[last] - u2[first]) / (*high - *low));
  }
  part.phase_rad2 = std::max(0.0, u2[first] - part.delay_s2 * *low);
  std::vector<double> line;
  std::transform(w2.begin(), w2.end(), std::back_inserter(line),
                 [&](double square) { return part.phase_rad2 + part.delay_s2 * square; });
  if (*std::min_element(line.begin(), line.end()) > 0.0) {
    const double lowered = std::min(1.0, least_ratio(u2, line));
    part.delay_s2 *= lowered;
    part.phase_rad2 *= lowered;
  }
  return part;
}

SharedPart shared_part(const RowOverFrequency& row, const std::vector<double>& w2) {
  if (row.is_delay) {
    return {least_ratio(row.u2_rad2, w2), 0.0};
  }
  return row.is_of_reference ? delay_and_phase(row.u2_rad2, w2) : SharedPart{};
}

} // namespace

SharedPhaseUncertainty shared_phase_uncertainty(std::span<const BudgetAtFrequency> frequencies) {
  std::vector<double> w2;
  for (const BudgetAtFrequency& one : frequencies) {
    w2.push_back(std::pow(2.0 * std::numbers::pi * one.frequency_hz, 2));
  }
  SharedPart all;
  std::vector<double> beyond2(frequencies.size(), 0.0);
  for (const auto& [name, row] : rows_that_repeat(frequencies)) {
    const SharedPart part = shared_part(row, w2);
    all.delay_s2 += part.delay_s2;
    all.phase_rad2 += part.phase_rad2;
    for (std::size_t i = 0; i < w2.size(); ++i) {
      const double shared = part.delay_s2 * w2[i] + part.phase_rad2;
      const double rest = row.u2_rad2[i] - shared;
      beyond2[i] += rest > 1e-12 * shared ? rest : 0.0; // else rounding
    }
  }
  SharedPhaseUncertainty result{{std::sqrt(all.delay_s2), std::sqrt(all.phase_rad2)}, {}};
  std::transform(beyond2.begin(), beyond2.end(), std::back_inserter(result.beyond_rad),
                 [](double square) { return std::sqrt(square); });
  return result;
}

} // namespace dyncal::inline evaluation
