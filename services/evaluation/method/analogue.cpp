#include "services/evaluation/method/analogue.hpp"

#include "analysis/method/analogue_comparison.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_settling.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/recipe/reference_correction.hpp"

namespace dyncal::inline evaluation {
namespace {

bool has_sync(const AnalogueRoles& roles) {
  return roles.excitation != roles.reference;
}

// Of the selected channels.
std::size_t first_dut(const StepTask& task) {
  return has_sync(std::get<AnalogueRoles>(task.recipe->roles)) ? 2 : 1;
}

// The reference, sync where it is named, then the channels under calibration.
SelectedChannels select_channels(const Recipe& recipe, SourceInterval source) {
  const auto& roles = std::get<AnalogueRoles>(recipe.roles);
  std::vector<ChannelName> names{roles.reference};
  if (has_sync(roles)) {
    names.push_back(roles.excitation);
  }
  names.insert(names.end(), roles.dut.begin(), roles.dut.end());
  return {std::move(source), std::move(names), recipe.mains_hz};
}

void leave_settling_out(StepTask& task, SelectedChannels& channels) {
  const StepSettling settling = find_settling_of_step(
      task.step(), task.recipe->frequency_search_rel, {channels.samples(), 0, {0}},
      sensor_columns(channels, first_dut(task)));
  if (settling.flag) {
    task.flags.push_back(*settling.flag);
  }
  channels.narrow(
      without_settling(channels.interval(), settling.settling_s, task.step().duration_s));
}

analysis::AnalogueInput input_of(const StepTask& task, const SelectedChannels& channels,
                                 const analysis::ReferenceResponse& reference) {
  const Recipe& recipe = *task.recipe;
  analysis::AnalogueInput input{.frequency = task.step().frequency};
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.stamps_ns = channels.stamps_ns();
  input.reference = channels.channel(0);
  if (first_dut(task) > 1) {
    input.sync = channels.channel(1);
  }
  input.dut = channels.channels_from(first_dut(task));
  input.reference_response = reference;
  input.channel_delay_s = -recipe.reference_delay_s;
  input.systematic.reference_magnitude_rel = recipe.systematic.reference_magnitude_rel;
  input.systematic.reference_phase_rad = recipe.systematic.reference_phase_rad;
  input.systematic.channel_delay_s = recipe.systematic.acs_delay_s;
  return input;
}

std::vector<StepResult> evaluate(StepTask task, SourceInterval acs) {
  const auto& roles = std::get<AnalogueRoles>(task.recipe->roles);
  SelectedChannels channels = select_channels(*task.recipe, std::move(acs));
  if (task.recipe->settling_from_data) {
    leave_settling_out(task, channels);
  }
  const auto evaluated = evaluate_without_knocks(task, {&channels}, [&] {
    return reference_response(*task.recipe, task.step())
        .and_then([&](const analysis::ReferenceResponse& reference) {
          return analysis::evaluate_analogue(input_of(task, channels, reference));
        })
        .map([](const analysis::ComparisonResult& result) {
          EvaluatedStep step{{result.reference}, result.points, result.findings};
          if (result.sync) {
            step.common_fits.push_back(*result.sync);
          }
          return step;
        });
  });
  StepInput input{.dut = roles.dut,
                  .reference_unit = channels.unit(0),
                  .units = units_of(channels, channels, first_dut(task)),
                  .samples = {channels.summary()},
                  .data_sha256 = digest_of({&channels}),
                  .common = {{&channels, 0}},
                  .first_dut = {&channels, first_dut(task)}};
  if (has_sync(roles)) {
    input.common.push_back({&channels, 1});
  }
  return make_results(task, input, evaluated);
}

} // namespace

std::vector<SearchedChannel> Analogue::searches() const {
  return {{roles_.excitation, {roles_.excitation.source}}};
}

Evaluation Analogue::evaluation(std::size_t step, const RunRecords& records) {
  const auto interval = records.interval(0, step);
  if (!interval) {
    return [results = results_without_value(records.planned(step), roles_.dut,
                                            no_sine(*recipe_, records, step, roles_.excitation))](
               const std::stop_token&) { return results; };
  }
  SourceInterval acs = records.samples(roles_.reference.source, *interval);
  StepTask task = make_step_task(recipe_, step, records, {acs});
  return [task = std::move(task), acs = std::move(acs)](const std::stop_token& stop) {
    return evaluate(task.until(stop), acs);
  };
}

} // namespace dyncal::inline evaluation
