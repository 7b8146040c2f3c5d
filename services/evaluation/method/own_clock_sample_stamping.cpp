#include "services/evaluation/method/own_clock_sample_stamping.hpp"

#include <iterator>

#include "analysis/method/sample_stamping.hpp"
#include "services/evaluation/method/adc_correction.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/own_clock_sensors.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/recipe/reference_correction.hpp"

namespace dyncal::inline evaluation {
namespace {

struct StepChannels {
  SelectedChannels acs;  // reference, sync
  SelectedChannels sync; // of the DAU
  SelectedChannels dut;  // of the sensor
};

struct StepSources {
  SourceInterval acs;
  SourceInterval dau;
  std::vector<SourceInterval> sensors;
};

analysis::Expected<EvaluatedStep> evaluate_channels(const StepTask& task,
                                                    const StepChannels& channels) {
  const Recipe& recipe = *task.recipe;
  DYNCAL_TRY(require_samples(channels.dut));
  DYNCAL_TRY(const auto adc,
             adc_response(std::get<SampleStampingRoles>(recipe.roles), task.step()));
  DYNCAL_TRY(const auto reference, reference_response(recipe, task.step()));
  analysis::SampleStampingInput input{.frequency = task.step().frequency,
                                      .frequency_search_rel = recipe.frequency_search_rel,
                                      .acs_stamps_ns = channels.acs.stamps_ns(),
                                      .reference = channels.acs.channel(0),
                                      .sync_acs = channels.acs.channel(1),
                                      .dau_stamps_ns = channels.sync.stamps_ns(),
                                      .sync_dau = channels.sync.channel(0),
                                      .dut = channels.dut.channels_from(0),
                                      .dut_stamps_ns = channels.dut.stamps_ns(),
                                      .adc = adc,
                                      .reference_delay_s = recipe.reference_delay_s,
                                      .reference_response = reference,
                                      .systematic = recipe.systematic};
  input.systematic.dau_tick_s = channels.sync.record().description().tick_s;
  input.systematic.dut_tick_s = channels.dut.record().description().tick_s;
  input.systematic.clock_offset_s = u_clock_offset_s(channels.sync, channels.dut);
  return analysis::evaluate_sample_stamping(input).map(
      [](const analysis::SampleStampingResult& result) {
        return EvaluatedStep{
            {result.reference, result.sync_acs, result.sync_dau}, result.points, result.findings};
      });
}

std::vector<StepResult> evaluate_sensor(StepTask task, const StepSources& sources,
                                        const SourceInterval& sensor) {
  const auto& roles = std::get<SampleStampingRoles>(task.recipe->roles);
  StepChannels channels{
      .acs = {sources.acs, {roles.reference, roles.sync_acs}, task.recipe->mains_hz},
      .sync = {sources.dau, {roles.sync_dau}, task.recipe->mains_hz},
      .dut = select_dut(*task.recipe, sensor)};
  flag_unknown_clock(channels.sync, task.flags);
  flag_unknown_clock(channels.dut, task.flags);
  const auto step = evaluate_without_knocks(task, {&channels.acs, &channels.sync, &channels.dut},
                                            [&] { return evaluate_channels(task, channels); });
  return make_results(
      task,
      {.dut = dut_of(*task.recipe, sensor.record->source()),
       .reference_unit = channels.acs.unit(0),
       .units = units_of(channels.acs, channels.dut, 0),
       .samples = {channels.acs.summary(), channels.sync.summary(), channels.dut.summary()},
       .data_sha256 = digest_of({&channels.acs, &channels.sync, &channels.dut}),
       .common = {{&channels.acs, 0}, {&channels.acs, 1}, {&channels.sync, 0}},
       .first_dut = {&channels.dut, 0}},
      step);
}

std::vector<StepResult> evaluate(const StepTask& task, const StepSources& sources) {
  std::vector<StepResult> results;
  for (const SourceInterval& sensor : sources.sensors) {
    auto of_sensor = evaluate_sensor(task, sources, sensor);
    std::move(of_sensor.begin(), of_sensor.end(), std::back_inserter(results));
  }
  return results;
}

} // namespace

std::vector<SearchedChannel> OwnClockSampleStamping::searches() const {
  std::vector<std::string> beside = recipe_->dut_sources();
  beside.insert(beside.begin(), roles_.sync_dau.source);
  return {{roles_.sync_acs, {roles_.sync_acs.source}}, {roles_.sync_dau, std::move(beside)}};
}

Expected<void> OwnClockSampleStamping::check_time_scales(const RunRecords& records) const {
  return check_one_time_scale(*recipe_, records, roles_.sync_dau.source);
}

bool OwnClockSampleStamping::is_complete(std::size_t step, const RunRecords& records) const {
  return sensors_have_sent(*recipe_, records, 1, step);
}

Evaluation OwnClockSampleStamping::evaluation(std::size_t step, const RunRecords& records) {
  const auto of_acs = records.interval(0, step);
  const auto of_dau = records.interval(1, step);
  if (!of_acs || !of_dau) {
    const ChannelName& sync = of_acs ? roles_.sync_dau : roles_.sync_acs;
    return [results = results_without_value(records.planned(step), roles_.dut,
                                            no_sine(*recipe_, records, step, sync))](
               const std::stop_token&) { return results; };
  }
  StepSources sources{records.samples(roles_.sync_acs.source, *of_acs),
                      records.samples(roles_.sync_dau.source, *of_dau),
                      sensor_intervals(*recipe_, records, *of_dau)};
  std::vector<SourceInterval> all{sources.acs, sources.dau};
  all.insert(all.end(), sources.sensors.begin(), sources.sensors.end());
  StepTask task = make_step_task(recipe_, step, records, all);
  return [task = std::move(task), sources = std::move(sources)](const std::stop_token& stop) {
    return evaluate(task.until(stop), sources);
  };
}

} // namespace dyncal::inline evaluation
