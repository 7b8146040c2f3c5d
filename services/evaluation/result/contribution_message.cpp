#include "services/evaluation/result/contribution_message.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace dyncal::inline evaluation {
namespace {

using analysis::ContributionKind;
using analysis::Distribution;
using analysis::Repeats;

constexpr auto kinds = std::to_array<std::pair<ContributionKind, wire::ContributionKind>>({
    {ContributionKind::other, wire::CONTRIBUTION_OTHER},
    {ContributionKind::fit_noise, wire::CONTRIBUTION_FIT_NOISE},
    {ContributionKind::quantisation, wire::CONTRIBUTION_QUANTISATION},
    {ContributionKind::rice, wire::CONTRIBUTION_RICE},
    {ContributionKind::structure, wire::CONTRIBUTION_STRUCTURE},
    {ContributionKind::stamp_jitter, wire::CONTRIBUTION_STAMP_JITTER},
    {ContributionKind::stamp_tick, wire::CONTRIBUTION_STAMP_TICK},
    {ContributionKind::sync_jitter, wire::CONTRIBUTION_SYNC_JITTER},
    {ContributionKind::adc_phase, wire::CONTRIBUTION_ADC_PHASE},
    {ContributionKind::channel_delay, wire::CONTRIBUTION_CHANNEL_DELAY},
    {ContributionKind::reference, wire::CONTRIBUTION_REFERENCE},
    {ContributionKind::record_frequency, wire::CONTRIBUTION_RECORD_FREQUENCY},
    {ContributionKind::clock_offset, wire::CONTRIBUTION_CLOCK_OFFSET},
    {ContributionKind::apparent_frequency, wire::CONTRIBUTION_APPARENT_FREQUENCY},
    {ContributionKind::trigger_delay, wire::CONTRIBUTION_TRIGGER_DELAY},
    {ContributionKind::series_start, wire::CONTRIBUTION_SERIES_START},
    {ContributionKind::shots, wire::CONTRIBUTION_SHOTS},
    {ContributionKind::trace_clock, wire::CONTRIBUTION_TRACE_CLOCK},
    {ContributionKind::mains_hum, wire::CONTRIBUTION_MAINS_HUM},
    {ContributionKind::folded_harmonic, wire::CONTRIBUTION_FOLDED_HARMONIC},
    {ContributionKind::background, wire::CONTRIBUTION_BACKGROUND},
});
static_assert(kinds.size() == static_cast<std::size_t>(ContributionKind::other) + 1);

constexpr auto distributions = std::to_array<std::pair<Distribution, wire::Distribution>>({
    {Distribution::normal, wire::DISTRIBUTION_NORMAL},
    {Distribution::rectangular, wire::DISTRIBUTION_RECTANGULAR},
    {Distribution::triangular, wire::DISTRIBUTION_TRIANGULAR},
    {Distribution::arcsine, wire::DISTRIBUTION_ARCSINE},
});

constexpr auto repeated = std::to_array<std::pair<Repeats, wire::Repeats>>({
    {Repeats::common, wire::REPEATS_COMMON},
    {Repeats::common_delay, wire::REPEATS_COMMON_DELAY},
    {Repeats::anew, wire::REPEATS_ANEW},
});

// The first pair of a table is what an unknown value is taken for.
template <class Table, class Value>
auto to_wire(const Table& table, Value value) {
  const auto found = std::find_if(std::begin(table), std::end(table),
                                  [&](const auto& pair) { return pair.first == value; });
  return found == std::end(table) ? table.front().second : found->second;
}

template <class Table, class Value>
auto from_wire(const Table& table, Value value) {
  const auto found = std::find_if(std::begin(table), std::end(table),
                                  [&](const auto& pair) { return pair.second == value; });
  return found == std::end(table) ? table.front().first : found->first;
}

} // namespace

wire::BudgetContribution to_message(const analysis::Contribution& row) {
  wire::BudgetContribution message;
  message.kind(to_wire(kinds, row.kind));
  message.subject(row.subject);
  message.name(row.name());
  message.distribution(to_wire(distributions, row.distribution));
  message.repeats(to_wire(repeated, row.repeats));
  message.degrees_of_freedom(row.degrees_of_freedom);
  message.u_magnitude_rel(row.u_magnitude_rel);
  message.u_lasting_magnitude_rel(row.u_lasting_magnitude_rel);
  message.u_phase_rad(row.u_phase_rad);
  return message;
}

analysis::Contribution from_message(const wire::BudgetContribution& message) {
  const ContributionKind kind = from_wire(kinds, message.kind());
  return {.kind = kind,
          .subject = kind == ContributionKind::other ? message.name() : message.subject(),
          .distribution = from_wire(distributions, message.distribution()),
          .repeats = from_wire(repeated, message.repeats()),
          .degrees_of_freedom = message.degrees_of_freedom(),
          .u_magnitude_rel = message.u_magnitude_rel(),
          .u_phase_rad = message.u_phase_rad(),
          .u_lasting_magnitude_rel = message.u_lasting_magnitude_rel()};
}

} // namespace dyncal::inline evaluation
