#include "services/evaluation/contribution_message.hpp"

#include <cmath>
#include <string>

namespace dyncal::services {

wire::BudgetContribution contribution_message(const analysis::Contribution& row) {
  wire::BudgetContribution message;
  message.name(row.name());
  message.distribution(std::string(to_string(row.distribution)));
  message.degrees_of_freedom(std::isinf(row.degrees_of_freedom) ? 0.0 : row.degrees_of_freedom);
  message.u_magnitude_rel(row.u_magnitude_rel);
  message.u_phase_rad(row.u_phase_rad);
  return message;
}

analysis::Contribution contribution_of(const wire::BudgetContribution& message) {
  analysis::NamedKind named = analysis::parse_contribution_name(message.name());
  analysis::Contribution row{.kind = named.kind, .subject = std::move(named.subject)};
  row.distribution =
      analysis::parse_distribution(message.distribution()).value_or(analysis::Distribution::normal);
  if (message.degrees_of_freedom() > 0.0) {
    row.degrees_of_freedom = message.degrees_of_freedom();
  }
  row.u_magnitude_rel = message.u_magnitude_rel();
  row.u_phase_rad = message.u_phase_rad();
  if (row.kind == analysis::ContributionKind::stamp_jitter ||
      row.kind == analysis::ContributionKind::stamp_tick) {
    row.u_lasting_magnitude_rel = row.u_magnitude_rel;
  }
  return row;
}

} // namespace dyncal::services
