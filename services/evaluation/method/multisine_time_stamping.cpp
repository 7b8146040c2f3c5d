#include <optional>

#include "analysis/method/multisine_stamping.hpp"
#include "services/evaluation/method/calibrated_channels.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/method_kinds.hpp"
#include "services/evaluation/method/reference_channel.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/method/two_clocks.hpp"

namespace dyncal::inline evaluation {
namespace {

// Of line `line` of the excitation, whose first step the task is about.
StepTask task_of_line(const StepTask& task, std::size_t line) {
  StepTask one = task;
  one.index += line;
  return one;
}

analysis::Expected<analysis::MultisineStampingResult>
evaluate_channels(const StepTask& task, const SelectedChannels& acs, const SelectedChannels& dau) {
  const Recipe& recipe = *task.recipe;
  DYNCAL_TRY(const auto reference_samples, reference_channel(acs));
  analysis::MultisineStampingInput input{.lines = {},
                                         .period_s = recipe.multisine_period_s,
                                         .frequency_search_rel = recipe.frequency_search_rel,
                                         .acs_stamps_ns = acs.stamps_ns(),
                                         .reference = reference_samples,
                                         .sync_acs = acs.channel(1),
                                         .dau_stamps_ns = dau.stamps_ns(),
                                         .sync_dau = dau.channel(0),
                                         .dut = dau.channels_from(1),
                                         .reference_delay_s = recipe.reference_delay_s,
                                         .systematic = recipe.systematic};
  input.systematic.dau_tick_s = dau.record().description().tick_s;
  for (std::size_t line = 0; line < recipe.lines_at_once(); ++line) {
    const RecipeStep& step = recipe.steps[task.index + line];
    DYNCAL_TRY(const auto adc, adc_response(recipe, step));
    DYNCAL_TRY(const auto reference, reference_response(recipe, step));
    input.lines.push_back({step.frequency, adc, reference});
  }
  return analysis::evaluate_multisine_stamping(input);
}

// Knocks are in what the lines leave, which is the same for all of them.
analysis::Expected<EvaluatedStep> findings_of(const analysis::MultisineStampingResult& result) {
  for (const auto& line : result.lines) {
    if (line) {
      return EvaluatedStep{{}, {}, line->findings};
    }
  }
  return EvaluatedStep{};
}

analysis::Expected<EvaluatedStep> step_of_line(const analysis::MultisineStampingResult& result,
                                               std::size_t line) {
  return result.lines[line].map([](const analysis::EvaluatedLine& one) {
    return EvaluatedStep{{one.reference, one.sync_acs, one.sync_dau}, one.points, one.findings};
  });
}

std::vector<StepResult> evaluate(StepTask task, SourceInterval acs_source,
                                 SourceInterval dau_source) {
  const RoleNames& roles = task.recipe->roles;
  const std::vector<ChannelName> dut = calibrated_channels(*task.recipe, *dau_source.record);
  std::vector<ChannelName> of_dau{roles.sync_sensor};
  of_dau.insert(of_dau.end(), dut.begin(), dut.end());
  SelectedChannels acs(std::move(acs_source), {roles.reference, roles.sync_acs},
                       task.recipe->mains_hz);
  SelectedChannels dau(std::move(dau_source), std::move(of_dau), task.recipe->mains_hz);
  std::optional<analysis::MultisineStampingResult> result;
  const auto evaluated =
      evaluate_without_knocks(task, {&acs, &dau}, [&]() -> analysis::Expected<EvaluatedStep> {
        DYNCAL_TRY(result, evaluate_channels(task, acs, dau));
        return findings_of(*result);
      });
  StepInput input{.dut = dut,
                  .reference_unit = excitation_unit(acs),
                  .units = units_of(acs, dau, 1),
                  .samples = {acs.summary(), dau.summary()},
                  .data_sha256 = digest_of({&acs, &dau}),
                  .common = {{&acs, 0}, {&acs, 1}, {&dau, 0}},
                  .first_dut = {&dau, 1},
                  .rests = {}};
  if (evaluated) {
    input.rests = result->rests;
  }
  std::vector<StepResult> results;
  for (std::size_t line = 0; line < task.recipe->lines_at_once(); ++line) {
    const auto step = evaluated ? step_of_line(*result, line) : evaluated;
    for (StepResult& one : make_results(task_of_line(task, line), input, step)) {
      results.push_back(std::move(one));
    }
  }
  return results;
}

// Sample time stamping of a multi-sine: all lines of an excitation in one evaluation, one result a
// line (analysis/method/multisine_stamping.hpp).
//
// The excitation is found in the first line, with all others taken away. Lines share their samples,
// the link of the clocks and what is known of the instruments: rows of the budget that are the same
// error of time for all of them are common delays, and count in full in a group delay.
class MultisineTimeStamping : public TwoClocks {
public:
  using TwoClocks::TwoClocks;

private:
  [[nodiscard]] StepEvaluation step_evaluation() const override { return evaluate; }

  [[nodiscard]] Evaluation without(std::size_t step, const RunRecords& records,
                                   const ChannelName& sync) const override {
    const auto dut = calibrated_channels(*recipe_, records.of(roles_.sync_sensor.source));
    const std::string problem = no_sine(*recipe_, records, step, sync);
    std::vector<StepResult> results;
    for (const RecipeStep& line : records.excitation().order().lines(step)) {
      for (StepResult& one : results_without_value(line, dut, problem)) {
        results.push_back(std::move(one));
      }
    }
    return [results = std::move(results)](const std::stop_token&) { return results; };
  }
};

} // namespace

std::unique_ptr<Method> make_multisine_time_stamping(std::shared_ptr<const Recipe> recipe) {
  return std::make_unique<MultisineTimeStamping>(std::move(recipe));
}

} // namespace dyncal::inline evaluation
