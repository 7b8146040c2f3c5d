#include "services/evaluation/method/sample_time_stamping.hpp"

#include "analysis/method/sample_stamping.hpp"
#include "services/evaluation/method/adc_correction.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_settling.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/recipe/reference_correction.hpp"

namespace dyncal::inline evaluation {
namespace {

// The recipe's, or all of the DAU but sync, temperature and analogue inputs.
std::vector<ChannelName> channels_under_calibration(const Recipe& recipe, const SourceRecord& dau) {
  const auto& roles = std::get<SampleStampingRoles>(recipe.roles);
  if (!roles.dut.empty() || !dau.described()) {
    return roles.dut;
  }
  std::vector<ChannelName> names;
  for (const drivers::ChannelDescription& channel : dau.description().channels) {
    const ChannelName name{dau.source(), channel.name};
    const bool thermometer = channel.unit == R"(\degreecelsius)" || channel.unit == R"(\kelvin)";
    const bool analogue_input = channel.unit == R"(\volt)";
    if (name != roles.sync_dau && name != recipe.temperature && !thermometer && !analogue_input) {
      names.push_back(name);
    }
  }
  return names;
}

void leave_settling_out(StepTask& task, SelectedChannels& acs, SelectedChannels& dau) {
  const StepSettling settling = find_settling_of_step(
      task.step(), task.recipe->frequency_search_rel, {acs.samples(), 1, {0}}, sensor_columns(dau));
  if (settling.flag) {
    task.flags.push_back(*settling.flag);
  }
  for (SelectedChannels* part : {&acs, &dau}) {
    part->narrow(without_settling(part->interval(), settling.settling_s, task.step().duration_s));
  }
}

analysis::Expected<EvaluatedStep>
evaluate_channels(const StepTask& task, const SelectedChannels& acs, const SelectedChannels& dau) {
  const Recipe& recipe = *task.recipe;
  DYNCAL_TRY(const auto adc,
             adc_response(std::get<SampleStampingRoles>(recipe.roles), task.step()));
  DYNCAL_TRY(const auto reference, reference_response(recipe, task.step()));
  analysis::SampleStampingInput input{.frequency = task.step().frequency,
                                      .frequency_search_rel = recipe.frequency_search_rel,
                                      .acs_stamps_ns = acs.stamps_ns(),
                                      .reference = acs.channel(0),
                                      .sync_acs = acs.channel(1),
                                      .dau_stamps_ns = dau.stamps_ns(),
                                      .sync_dau = dau.channel(0),
                                      .dut = dau.channels_from(1),
                                      .adc = adc,
                                      .reference_delay_s = recipe.reference_delay_s,
                                      .reference_response = reference,
                                      .systematic = recipe.systematic};
  input.systematic.dau_tick_s = dau.record().description().tick_s;
  return analysis::evaluate_sample_stamping(input).map(
      [](const analysis::SampleStampingResult& result) {
        return EvaluatedStep{
            {result.reference, result.sync_acs, result.sync_dau}, result.points, result.findings};
      });
}

std::vector<StepResult> evaluate(StepTask task, SourceInterval acs_source,
                                 SourceInterval dau_source) {
  const auto& roles = std::get<SampleStampingRoles>(task.recipe->roles);
  const std::vector<ChannelName> dut = channels_under_calibration(*task.recipe, *dau_source.record);
  std::vector<ChannelName> of_dau{roles.sync_dau};
  of_dau.insert(of_dau.end(), dut.begin(), dut.end());
  SelectedChannels acs(std::move(acs_source), {roles.reference, roles.sync_acs},
                       task.recipe->mains_hz);
  SelectedChannels dau(std::move(dau_source), std::move(of_dau), task.recipe->mains_hz);
  if (task.recipe->settling_from_data) {
    leave_settling_out(task, acs, dau);
  }
  const auto step = evaluate_without_knocks(task, {&acs, &dau},
                                            [&] { return evaluate_channels(task, acs, dau); });
  return make_results(task,
                      {.dut = dut,
                       .reference_unit = acs.unit(0),
                       .units = units_of(acs, dau, 1),
                       .samples = {acs.summary(), dau.summary()},
                       .data_sha256 = digest_of({&acs, &dau}),
                       .common = {{&acs, 0}, {&acs, 1}, {&dau, 0}},
                       .first_dut = {&dau, 1}},
                      step);
}

} // namespace

std::vector<SearchedChannel> SampleTimeStamping::searches() const {
  return {{roles_.sync_acs, {roles_.sync_acs.source}}, {roles_.sync_dau, {roles_.sync_dau.source}}};
}

Evaluation SampleTimeStamping::evaluation(std::size_t step, const RunRecords& records) {
  const auto of_acs = records.interval(0, step);
  const auto of_dau = records.interval(1, step);
  if (!of_acs || !of_dau) {
    const auto dut = channels_under_calibration(*recipe_, records.of(roles_.sync_dau.source));
    const ChannelName& sync = of_acs ? roles_.sync_dau : roles_.sync_acs;
    return [results = results_without_value(records.planned(step), dut,
                                            no_sine(*recipe_, records, step, sync))](
               const std::stop_token&) { return results; };
  }
  SourceInterval acs = records.samples(roles_.sync_acs.source, *of_acs);
  SourceInterval dau = records.samples(roles_.sync_dau.source, *of_dau);
  StepTask task = make_step_task(recipe_, step, records, {acs, dau});
  return [task = std::move(task), acs = std::move(acs), dau = std::move(dau)](
             const std::stop_token& stop) { return evaluate(task.until(stop), acs, dau); };
}

} // namespace dyncal::inline evaluation
