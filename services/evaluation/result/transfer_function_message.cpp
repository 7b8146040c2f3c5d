#include "services/evaluation/result/result_messages.hpp"

#include <array>
#include <complex>
#include <utility>

#include "services/base/per_enumerator.hpp"
#include "services/base/version.hpp"
#include "services/contract/evaluation_method_message.hpp"
#include "services/contract/message_members.hpp"
#include "services/evaluation/result/flag_message.hpp"

namespace dyncal::inline evaluation {

void message_members(auto& visit, Either<FrequencyPoint> auto& point, auto& message) {
  visit(point.frequency_text_hz, message.frequency_text_hz());
  visit(point.frequency_hz, message.frequency_hz());
  visit(point.level_m_s2, message.level_m_s2());
  visit(point.mean.magnitude, message.magnitude());
  visit(point.mean.u_magnitude, message.u_magnitude());
  visit(point.mean.phase_rad, message.phase_rad());
  visit(point.mean.u_phase_rad, message.u_phase_rad());
  visit(point.unwrapped_phase_rad, message.unwrapped_phase_rad());
  visit(point.mean.scatter_magnitude, message.scatter_magnitude());
  visit(point.mean.scatter_phase_rad, message.scatter_phase_rad());
  visit(point.mean.repetitions, message.repetitions());
}

void message_members(auto& visit, Either<analysis::RepetitionMean> auto& mean, auto& message) {
  visit(mean.magnitude_rel.u, message.u_magnitude_rel());
  visit(mean.magnitude_rel.degrees_of_freedom, message.degrees_of_freedom_magnitude());
  visit(mean.magnitude_rel.k, message.k_magnitude());
  visit(mean.phase.u, message.u_phase_rad());
  visit(mean.phase.degrees_of_freedom, message.degrees_of_freedom_phase());
  visit(mean.phase.k, message.k_phase());
  visit(mean.u_independent_phase_rad, message.u_independent_phase_rad());
}

constexpr std::array verdicts{
    std::pair{Verdict::not_possible, wire::CLOSURE_NOT_POSSIBLE},
    std::pair{Verdict::closes, wire::CLOSURE_CLOSES},
    std::pair{Verdict::open, wire::CLOSURE_OPEN},
};

// But for its kind.
void message_members(auto& visit, Either<Closure> auto& closure, auto& message) {
  visit(closure.subject, message.subject());
  visit.named(closure.verdict, message.verdict(), verdicts);
  visit(closure.value, message.value());
  visit(closure.u, message.u());
  visit(closure.limit, message.limit());
  visit(closure.unit, message.unit());
  visit(closure.sentence, message.sentence());
}

void message_members(auto& visit, Either<TransferFunction> auto& function, auto& message) {
  visit(function.channel, message.channel());
  visit(function.unit, message.unit());
  visit(function.excited_axis, message.excited_axis());
  visit(function.points, message.points());
  if (auto* delay = visit.present(function.group_delay, message.group_delay_valid())) {
    visit(delay->delay_s, message.group_delay_s());
    visit(delay->of_delay.u, message.combined_u_group_delay_s());
    visit(delay->of_delay.degrees_of_freedom, message.nu_eff_group_delay());
    visit(delay->of_delay.k, message.k_group_delay());
    visit(delay->intercept_rad, message.intercept_rad());
    visit(delay->of_intercept.u, message.combined_u_intercept_rad());
    visit(delay->of_intercept.degrees_of_freedom, message.nu_eff_intercept());
    visit(delay->of_intercept.k, message.k_intercept());
    visit(delay->cov_delay_intercept, message.cov_delay_intercept_rad_s());
    visit(delay->phase_covariance, message.phase_covariance_rad2());
    visit(delay->polarity_inverted, message.polarity_inverted());
    visit(delay->chi_squared, message.group_delay_chi_squared());
    visit(delay->degrees_of_freedom, message.group_delay_degrees_of_freedom());
  }
  visit(function.group_delay_problem, message.group_delay_problem());
  message_flags(visit, function.flags, message);
  visit(function.lost, message.lost());
}

namespace {

// As a writer of an older contract has it: U / 2 alone.
void take_half_expanded(double half_expanded, analysis::CombinedUncertainty& uncertainty) {
  if (uncertainty.k == 0.0) {
    uncertainty = {.u = half_expanded};
  }
}

} // namespace

wire::TransferFunction to_message(const Recipe& recipe, const TransferFunction& function) {
  wire::TransferFunction message;
  MessageWriter writer;
  message_members(writer, function, message);
  for (const FrequencyPoint& point : function.points) {
    message_members(writer, point.mean, message.mean_uncertainties().emplace_back());
  }
  for (const Closure& closure : function.closures) {
    message_members(writer, closure, message.closures().emplace_back());
    message.closures().back().kind(std::string(to_string(closure.kind)));
  }
  if (function.group_delay) {
    message.u_group_delay_s(function.group_delay->u_delay_s());
    message.u_intercept_rad(function.group_delay->u_intercept_rad());
  }
  message.bench(recipe.bench);
  message.run(recipe.run);
  message.method(to_wire(function.method));
  message.software(software_version());
  message.recipe_sha256(recipe.sha256);
  return message;
}

TransferFunction from_message(const wire::TransferFunction& message) {
  TransferFunction function;
  MessageReader reader;
  message_members(reader, function, message);
  if (function.group_delay) {
    take_half_expanded(message.u_group_delay_s(), function.group_delay->of_delay);
    take_half_expanded(message.u_intercept_rad(), function.group_delay->of_intercept);
  }
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    analysis::RepetitionMean& mean = function.points[i].mean;
    mean.h = std::polar(mean.magnitude, mean.phase_rad);
    if (i < message.mean_uncertainties().size()) {
      message_members(reader, mean, message.mean_uncertainties()[i]);
    }
  }
  for (const wire::Closure& closure : message.closures()) {
    // Not of a kind that this version does not know: its flag says what is open.
    if (const auto kind = parse_enumerator<ClosureKind>(closure.kind())) {
      message_members(reader, function.closures.emplace_back(), closure);
      function.closures.back().kind = *kind;
    }
  }
  function.method = from_wire(message.method()).value_or(EvaluationMethod::sample_timestamping);
  return function;
}

} // namespace dyncal::inline evaluation
