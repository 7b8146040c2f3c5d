#include "analysis/method/sample_stamping.hpp"
#include "services/evaluation/method/calibrated_channels.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/method_kinds.hpp"
#include "services/evaluation/method/own_clock_sensors.hpp"
#include "services/evaluation/method/reference_channel.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_settling.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/method/two_clocks.hpp"

namespace dyncal::inline evaluation {
namespace {

void leave_settling_out(StepTask& task, SelectedChannels& acs, SelectedChannels& dau) {
  const StepSamples samples = settling_samples(acs, task.step().frequency.hz());
  const StepSettling settling = find_settling_of_step(
      task.step(), task.recipe->frequency_search_rel, {samples, 1, {0}}, sensor_columns(dau));
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
  DYNCAL_TRY(const auto adc, adc_response(recipe, task.step()));
  DYNCAL_TRY(const auto reference, reference_response(recipe, task.step()));
  DYNCAL_TRY(const auto reference_samples, reference_channel(acs));
  analysis::SampleStampingInput input{.frequency = task.step().frequency,
                                      .frequency_search_rel = recipe.frequency_search_rel,
                                      .acs_stamps_ns = acs.stamps_ns(),
                                      .reference = reference_samples,
                                      .sync_acs = acs.channel(1),
                                      .dau_stamps_ns = dau.stamps_ns(),
                                      .sync_dau = dau.channel(0),
                                      .dut = dau.channels_from(1),
                                      .adc = adc,
                                      .reference_delay_s = recipe.reference_delay_s,
                                      .reference_response = reference,
                                      .systematic = recipe.systematic};
  input.systematic.dau_tick_s = dau.record().description().tick_s;
  input.u_utc_s = u_utc_s(acs, dau);
  return analysis::evaluate_sample_stamping(input).map(
      [](const analysis::SampleStampingResult& result) {
        return EvaluatedStep{
            {result.reference, result.sync_acs, result.sync_dau}, result.points, result.findings};
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
  if (task.recipe->settling_from_data) {
    leave_settling_out(task, acs, dau);
  }
  const auto step = evaluate_without_knocks(task, {&acs, &dau},
                                            [&] { return evaluate_channels(task, acs, dau); });
  return make_results(task,
                      {.dut = dut,
                       .reference_unit = excitation_unit(acs),
                       .units = units_of(acs, dau, 1),
                       .samples = {acs.summary(), dau.summary()},
                       .data_sha256 = digest_of({&acs, &dau}),
                       .common = {{&acs, 0}, {&acs, 1}, {&dau, 0}},
                       .first_dut = {&dau, 1}},
                      step);
}

// The DAU stamps every sample of the sensor and of sync; sync links its clock to that of the ACS:
// sample time stamping, paper eqs. (1), (3), (4) (analysis/method/sample_stamping.hpp).
//
// Without channels under calibration in the recipe, all channels of the DAU but sync and
// temperature are. The response of the DAU's sync ADC is corrected by the recipe's calibration.
class SampleTimeStamping : public TwoClocks {
public:
  using TwoClocks::TwoClocks;

private:
  [[nodiscard]] StepEvaluation step_evaluation() const override { return evaluate; }

  [[nodiscard]] Evaluation without(std::size_t step, const RunRecords& records,
                                   const ChannelName& sync) const override {
    return not_found(step, records, sync,
                     calibrated_channels(*recipe_, records.of(roles_.sync_sensor.source)));
  }
};

} // namespace

std::unique_ptr<Method> make_sample_time_stamping(std::shared_ptr<const Recipe> recipe) {
  return std::make_unique<SampleTimeStamping>(std::move(recipe));
}

} // namespace dyncal::inline evaluation
