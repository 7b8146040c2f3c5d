#include "services/evaluation/result/result_messages.hpp"

#include <array>
#include <utility>

#include "services/contract/message_members.hpp"

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
    {ContributionKind::transverse_motion, wire::CONTRIBUTION_TRANSVERSE_MOTION},
    {ContributionKind::motion_frequency, wire::CONTRIBUTION_MOTION_FREQUENCY},
    {ContributionKind::interferometer_ellipse, wire::CONTRIBUTION_INTERFEROMETER_ELLIPSE},
    {ContributionKind::periodic_error, wire::CONTRIBUTION_PERIODIC_ERROR},
    {ContributionKind::wavelength, wire::CONTRIBUTION_WAVELENGTH},
    {ContributionKind::detector_bandwidth, wire::CONTRIBUTION_DETECTOR_BANDWIDTH},
    {ContributionKind::detector_skew, wire::CONTRIBUTION_DETECTOR_SKEW},
    {ContributionKind::simultaneity, wire::CONTRIBUTION_SIMULTANEITY},
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

} // namespace

void message_members(auto& visit, Either<analysis::Contribution> auto& row, auto& message) {
  visit.named(row.kind, message.kind(), kinds);
  visit(row.subject, message.subject());
  visit.named(row.distribution, message.distribution(), distributions);
  visit.named(row.repeats, message.repeats(), repeated);
  visit(row.degrees_of_freedom, message.degrees_of_freedom());
  visit(row.u_magnitude_rel, message.u_magnitude_rel());
  visit(row.u_lasting_magnitude_rel, message.u_lasting_magnitude_rel());
  visit(row.u_phase_rad, message.u_phase_rad());
}

wire::BudgetContribution to_message(const analysis::Contribution& row) {
  wire::BudgetContribution message;
  MessageWriter writer;
  message_members(writer, row, message);
  message.name(row.name());
  return message;
}

analysis::Contribution from_message(const wire::BudgetContribution& message) {
  analysis::Contribution row;
  MessageReader reader;
  message_members(reader, row, message);
  if (row.kind == ContributionKind::other) {
    row.subject = message.name();
  }
  return row;
}

} // namespace dyncal::inline evaluation
