#include <fmt/format.h>
#include <iterator>

#include "analysis/method/analogue_comparison.hpp"
#include "services/evaluation/method/disturbance_cut.hpp"
#include "services/evaluation/method/method_kinds.hpp"
#include "services/evaluation/method/own_clock_sensors.hpp"
#include "services/evaluation/method/reference_channel.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {
namespace {

analysis::Expected<EvaluatedStep>
evaluate_channels(const StepTask& task, const SelectedChannels& acs, const SelectedChannels& dut) {
  const Recipe& recipe = *task.recipe;
  DYNCAL_TRY(require_samples(dut));
  DYNCAL_TRY(const auto reference, reference_response(recipe, task.step()));
  analysis::AbsoluteTimeInput input{.frequency = task.step().frequency};
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.reference_stamps_ns = acs.stamps_ns();
  DYNCAL_TRY(input.reference, reference_channel(acs));
  input.dut_stamps_ns = dut.stamps_ns();
  input.dut = dut.channels_from(0);
  input.reference_response = reference;
  input.channel_delay_s = -recipe.reference_delay_s;
  input.systematic = {.reference_magnitude_rel = recipe.systematic.reference_magnitude_rel,
                      .reference_phase_rad = recipe.systematic.reference_phase_rad,
                      .channel_delay_s = recipe.systematic.acs_delay_s,
                      .clock_offset_s = u_clock_offset_s(acs, dut),
                      .stamp_jitter_s = 0.0,
                      .reference_tick_s = acs.record().description().tick_s,
                      .dut_tick_s = dut.record().description().tick_s};
  return analysis::evaluate_absolute_time(input).map([](const analysis::ComparisonResult& result) {
    return EvaluatedStep{{result.reference}, result.points, result.findings};
  });
}

std::vector<StepResult> evaluate_sensor(StepTask task, const SourceInterval& acs_source,
                                        const SourceInterval& sensor) {
  const Recipe& recipe = *task.recipe;
  SelectedChannels acs(acs_source, {recipe.reference()}, recipe.mains_hz);
  SelectedChannels dut = select_dut(recipe, sensor);
  // A known delay of the ACS counts for its clock too, which describes no uncertainty of its own.
  if (recipe.systematic.acs_delay_s <= 0.0) {
    flag_unknown_clock(acs, task.flags);
  }
  flag_unknown_clock(dut, task.flags);
  const auto step = evaluate_without_knocks(task, {&acs, &dut},
                                            [&] { return evaluate_channels(task, acs, dut); });
  return make_results(task,
                      {.dut = dut_of(recipe, sensor.record->source()),
                       .reference_unit = excitation_unit(acs),
                       .units = units_of(acs, dut, 0),
                       .samples = {acs.summary(), dut.summary()},
                       .data_sha256 = digest_of({&acs, &dut}),
                       .common = {{&acs, 0}},
                       .first_dut = {&dut, 0}},
                      step);
}

std::vector<StepResult> evaluate(const StepTask& task, const SourceInterval& acs,
                                 const std::vector<SourceInterval>& sensors) {
  std::vector<StepResult> results;
  for (const SourceInterval& sensor : sensors) {
    auto of_sensor = evaluate_sensor(task, acs, sensor);
    std::move(of_sensor.begin(), of_sensor.end(), std::back_inserter(results));
  }
  return results;
}

// Reference and sensors are all stamped in UTC, and no sync is needed: absolute time
// (analysis/method/analogue_comparison.hpp).
class AbsoluteTime : public Method {
public:
  using Method::Method;

  [[nodiscard]] std::vector<SearchedChannel> searches() const override {
    std::vector<std::string> sources = recipe_->dut_sources();
    sources.insert(sources.begin(), recipe_->excitation().source);
    return {{recipe_->excitation(), std::move(sources)}};
  }

  [[nodiscard]] Expected<void> check_time_scales(const RunRecords& records) const override {
    std::vector<std::string> names = recipe_->dut_sources();
    names.push_back(roles_.reference.source);
    for (const std::string& name : names) {
      const SourceRecord& source = records.of(name);
      if (source.described() && source.description().time_base == drivers::TimeBase::local) {
        return fail(
            ErrorCode::no_source,
            fmt::format("source '{}' has a clock of its own, but absolute time needs all clocks on "
                        "UTC; set it to UTC and write time_base = \"utc\", or use a sync signal",
                        name));
      }
    }
    return {};
  }

  [[nodiscard]] bool is_complete(std::size_t step, const RunRecords& records) const override {
    return sensors_have_sent(*recipe_, records, 0, step);
  }

  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override {
    const auto interval = records.interval(0, step);
    if (!interval) {
      return not_found(step, records, recipe_->excitation(), roles_.dut);
    }
    SourceInterval acs = records.samples(roles_.reference.source, *interval);
    std::vector<SourceInterval> sensors = sensor_intervals(*recipe_, records, *interval);
    std::vector<SourceInterval> all{acs};
    all.insert(all.end(), sensors.begin(), sensors.end());
    StepTask task = make_step_task(recipe_, step, records, all);
    return [task = std::move(task), acs = std::move(acs), sensors = std::move(sensors)](
               const std::stop_token& stop) { return evaluate(task.until(stop), acs, sensors); };
  }

  [[nodiscard]] std::optional<std::string> clock_source() const override {
    return roles_.dut.front().source;
  }
};

} // namespace

std::unique_ptr<Method> make_absolute_time(std::shared_ptr<const Recipe> recipe) {
  return std::make_unique<AbsoluteTime>(std::move(recipe));
}

} // namespace dyncal::inline evaluation
