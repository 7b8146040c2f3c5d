#include <iterator>

#include "analysis/method/sample_stamping.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/method_kinds.hpp"
#include "services/evaluation/method/own_clock_sensors.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"

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
  DYNCAL_TRY(const auto adc, adc_response(recipe, task.step()));
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
  input.u_utc_s = u_utc_s(channels.acs, channels.sync);
  input.systematic.clock_offset_s = u_clock_offset_s(channels.sync, channels.dut);
  return analysis::evaluate_sample_stamping(input).map(
      [](const analysis::SampleStampingResult& result) {
        return EvaluatedStep{
            {result.reference, result.sync_acs, result.sync_dau}, result.points, result.findings};
      });
}

std::vector<StepResult> evaluate_sensor(StepTask task, const StepSources& sources,
                                        const SourceInterval& sensor) {
  const RoleNames& roles = task.recipe->roles;
  StepChannels channels{
      .acs = {sources.acs, {roles.reference, roles.sync_acs}, task.recipe->mains_hz},
      .sync = {sources.dau, {roles.sync_sensor}, task.recipe->mains_hz},
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

// Sample time stamping of sensors that have stamps of their own: a DAU on their time scale records
// sync beside them (analysis/method/sample_stamping.hpp).
class OwnClockSampleStamping : public Method {
public:
  using Method::Method;

  [[nodiscard]] std::vector<SearchedChannel> searches() const override {
    std::vector<std::string> beside = recipe_->dut_sources();
    beside.insert(beside.begin(), roles_.sync_sensor.source);
    return {{roles_.sync_acs, {roles_.sync_acs.source}}, {roles_.sync_sensor, std::move(beside)}};
  }

  [[nodiscard]] Expected<void> check_time_scales(const RunRecords& records) const override {
    return check_one_time_scale(*recipe_, records, roles_.sync_sensor.source);
  }

  [[nodiscard]] bool is_complete(std::size_t step, const RunRecords& records) const override {
    return sensors_have_sent(*recipe_, records, 1, step);
  }

  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override {
    const auto of_acs = records.interval(0, step);
    const auto of_dau = records.interval(1, step);
    if (!of_acs || !of_dau) {
      const ChannelName& sync = of_acs ? roles_.sync_sensor : roles_.sync_acs;
      return not_found(step, records, sync, roles_.dut);
    }
    StepSources sources{records.samples(roles_.sync_acs.source, *of_acs),
                        records.samples(roles_.sync_sensor.source, *of_dau),
                        sensor_intervals(*recipe_, records, *of_dau)};
    std::vector<SourceInterval> all{sources.acs, sources.dau};
    all.insert(all.end(), sources.sensors.begin(), sources.sensors.end());
    StepTask task = make_step_task(recipe_, step, records, all);
    return [task = std::move(task), sources = std::move(sources)](const std::stop_token& stop) {
      return evaluate(task.until(stop), sources);
    };
  }

  [[nodiscard]] std::optional<std::string> clock_source() const override {
    return roles_.dut.front().source;
  }
};

} // namespace

std::unique_ptr<Method> make_own_clock_sample_stamping(std::shared_ptr<const Recipe> recipe) {
  return std::make_unique<OwnClockSampleStamping>(std::move(recipe));
}

} // namespace dyncal::inline evaluation
