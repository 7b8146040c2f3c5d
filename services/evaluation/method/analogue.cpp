#include "analysis/method/analogue_comparison.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/method_kinds.hpp"
#include "services/evaluation/method/reference_channel.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_settling.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {
namespace {

bool has_sync(const Recipe& recipe) {
  return recipe.excitation() != recipe.reference();
}

// Of the selected channels.
std::size_t first_dut(const StepTask& task) {
  return has_sync(*task.recipe) ? 2 : 1;
}

// The reference, sync where it is named, then the channels under calibration.
SelectedChannels select_channels(const Recipe& recipe, SourceInterval source) {
  std::vector<ChannelName> names{recipe.reference()};
  if (has_sync(recipe)) {
    names.push_back(recipe.excitation());
  }
  names.insert(names.end(), recipe.dut().begin(), recipe.dut().end());
  return {std::move(source), std::move(names), recipe.mains_hz};
}

void leave_settling_out(StepTask& task, SelectedChannels& channels) {
  const StepSamples samples = settling_samples(channels, task.step().frequency.hz());
  const StepSettling settling =
      find_settling_of_step(task.step(), task.recipe->frequency_search_rel, {samples, 0, {0}},
                            sensor_columns(channels, first_dut(task)));
  if (settling.flag) {
    task.flags.push_back(*settling.flag);
  }
  channels.narrow(
      without_settling(channels.interval(), settling.settling_s, task.step().duration_s));
}

analysis::AnalogueInput input_of(const StepTask& task, const SelectedChannels& channels,
                                 const analysis::ChannelSamples& reference_samples,
                                 const analysis::ReferenceResponse& reference) {
  const Recipe& recipe = *task.recipe;
  analysis::AnalogueInput input{.frequency = task.step().frequency};
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.stamps_ns = channels.stamps_ns();
  input.reference = reference_samples;
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

analysis::Expected<EvaluatedStep> evaluate_channels(const StepTask& task,
                                                    const SelectedChannels& channels) {
  DYNCAL_TRY(const auto reference, reference_response(*task.recipe, task.step()));
  DYNCAL_TRY(const auto samples, reference_channel(channels));
  DYNCAL_TRY(const auto result,
             analysis::evaluate_analogue(input_of(task, channels, samples, reference)));
  EvaluatedStep step{{result.reference}, result.points, result.findings};
  if (result.sync) {
    step.common_fits.push_back(*result.sync);
  }
  return step;
}

std::vector<StepResult> evaluate(StepTask task, SourceInterval acs) {
  SelectedChannels channels = select_channels(*task.recipe, std::move(acs));
  if (task.recipe->settling_from_data) {
    leave_settling_out(task, channels);
  }
  const auto evaluated =
      evaluate_without_knocks(task, {&channels}, [&] { return evaluate_channels(task, channels); });
  StepInput input{.dut = task.recipe->dut(),
                  .reference_unit = excitation_unit(channels),
                  .units = units_of(channels, channels, first_dut(task)),
                  .samples = {channels.summary()},
                  .data_sha256 = digest_of({&channels}),
                  .common = {{&channels, 0}},
                  .first_dut = {&channels, first_dut(task)}};
  if (has_sync(*task.recipe)) {
    input.common.push_back({&channels, 1});
  }
  return make_results(task, input, evaluated);
}

// Sensor and reference are channels of one system: the analogue method, paper eqs. (1) and (2)
// (analysis/method/analogue_comparison.hpp). Sync beside them, where it is named, shows where the
// steps are and gives the frequency.
class Analogue : public Method {
public:
  using Method::Method;

  [[nodiscard]] std::vector<SearchedChannel> searches() const override {
    return {{recipe_->excitation(), {recipe_->excitation().source}}};
  }

  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override {
    const auto interval = records.interval(0, step);
    if (!interval) {
      return not_found(step, records, recipe_->excitation(), roles_.dut);
    }
    SourceInterval acs = records.samples(roles_.reference.source, *interval);
    StepTask task = make_step_task(recipe_, step, records, {acs});
    return [task = std::move(task), acs = std::move(acs)](const std::stop_token& stop) {
      return evaluate(task.until(stop), acs);
    };
  }
};

} // namespace

std::unique_ptr<Method> make_analogue(std::shared_ptr<const Recipe> recipe) {
  return std::make_unique<Analogue>(std::move(recipe));
}

} // namespace dyncal::inline evaluation
