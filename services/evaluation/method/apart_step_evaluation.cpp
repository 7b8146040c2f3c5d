#include "services/evaluation/method/apart_step_evaluation.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/method/analogue_comparison.hpp"
#include "services/evaluation/method/sample_stamping_step_evaluation.hpp"
#include "services/evaluation/monte_carlo_check.hpp"

namespace dyncal::services {
namespace {

// What both methods give: the fits that are common to all channels, and one point a channel.
struct Evaluated {
  std::vector<analysis::ChannelFit> common_fits;
  std::vector<analysis::TransferPoint> points;
};

analysis::ChannelSamples channel_samples(const SourceRecord& record, const StepSamples& samples,
                                         const ChannelName& name, std::size_t column) {
  return {name.text(), samples.columns[column],
          record.description().channels()[*record.channel(name.channel)].resolution()};
}

StepSamples cut_channels(const SourceRecord& record, const StretchOfTime& stretch,
                         const std::vector<ChannelName>& names) {
  std::vector<std::size_t> columns;
  for (const ChannelName& name : names) {
    columns.push_back(*record.channel(name.channel));
  }
  return cut(record, stretch, columns);
}

std::vector<analysis::ChannelSamples> all_channels(const SourceRecord& record,
                                                   const StepSamples& samples,
                                                   const std::vector<ChannelName>& names) {
  std::vector<analysis::ChannelSamples> channels;
  for (std::size_t i = 0; i < names.size(); ++i) {
    channels.push_back(channel_samples(record, samples, names[i], i));
  }
  return channels;
}

double clock_offset_s(const SourceRecord& a, const StretchOfTime& a_stretch, const SourceRecord& b,
                      const StretchOfTime& b_stretch) {
  return std::hypot(a.stamp_uncertainty_s(a_stretch.begin_ns, a_stretch.end_ns),
                    b.stamp_uncertainty_s(b_stretch.begin_ns, b_stretch.end_ns));
}

analysis::Expected<Evaluated> by_absolute_time(const Recipe& recipe, const RecipeStep& step,
                                               const ApartStep& samples, const StepSamples& acs,
                                               const SourceRecord& sensor, const StepSamples& dut,
                                               const std::vector<ChannelName>& names) {
  analysis::AbsoluteTimeInput input{.frequency = step.frequency};
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.reference_stamps_ns = acs.stamps_ns;
  input.reference = channel_samples(samples.acs, acs, recipe.reference, 0);
  input.dut_stamps_ns = dut.stamps_ns;
  input.dut = all_channels(sensor, dut, names);
  input.channel_delay_s = -recipe.reference_delay_s;
  input.systematic = {.reference_magnitude_rel = recipe.systematic.reference_magnitude_rel,
                      .reference_phase_rad = recipe.systematic.reference_phase_rad,
                      .channel_delay_s = recipe.systematic.acs_delay_s,
                      .clock_offset_s = clock_offset_s(samples.acs, samples.acs_stretch, sensor,
                                                       samples.acs_stretch),
                      .stamp_jitter_s = 0.0};
  return analysis::evaluate_absolute_time(input).map([](const analysis::ComparisonResult& result) {
    return Evaluated{{result.reference}, result.points};
  });
}

analysis::Expected<Evaluated> by_sync_beside(const Recipe& recipe, const RecipeStep& step,
                                             const ApartStep& samples, const StepSamples& acs,
                                             const StepSamples& sync, const SourceRecord& sensor,
                                             const StepSamples& dut,
                                             const std::vector<ChannelName>& names) {
  const auto adc = adc_response(recipe, step);
  if (!adc) {
    return fail(adc.error());
  }
  analysis::SampleStampingInput input{
      .frequency = step.frequency,
      .frequency_search_rel = recipe.frequency_search_rel,
      .acs_stamps_ns = acs.stamps_ns,
      .reference = channel_samples(samples.acs, acs, recipe.reference, 0),
      .sync_acs = channel_samples(samples.acs, acs, recipe.sync_acs, 1),
      .dau_stamps_ns = sync.stamps_ns,
      .sync_dau = channel_samples(*samples.sync, sync, recipe.sync_dau, 0),
      .dut = all_channels(sensor, dut, names),
      .dut_stamps_ns = dut.stamps_ns,
      .adc = *adc,
      .reference_delay_s = recipe.reference_delay_s,
      .systematic = recipe.systematic};
  input.systematic.dau_tick_s = samples.sync->description().tick_s();
  input.systematic.clock_offset_s =
      clock_offset_s(*samples.sync, samples.sync_stretch, sensor, samples.sync_stretch);
  return analysis::evaluate_sample_stamping(input).map(
      [](const analysis::SampleStampingResult& result) {
        return Evaluated{{result.reference, result.sync_acs, result.sync_dau}, result.points};
      });
}

void flag_unknown_clock(const SourceRecord& record, const StretchOfTime& stretch,
                        std::vector<std::string>& flags) {
  if (record.stamp_uncertainty_s(stretch.begin_ns, stretch.end_ns) <= 0.0) {
    flags.push_back(record.source() + ": nothing is known of the uncertainty of its clock");
  }
}

std::vector<wire::CalibrationResult> evaluate_sensor(const Recipe& recipe, const RecipeStep& step,
                                                     const ApartStep& samples,
                                                     const SourceRecord& sensor,
                                                     std::vector<std::string> flags) {
  std::vector<ChannelName> names;
  std::copy_if(recipe.dut.begin(), recipe.dut.end(), std::back_inserter(names),
               [&](const ChannelName& name) { return name.source == sensor.source(); });
  const bool absolute = samples.sync == nullptr;
  const StretchOfTime& stretch = absolute ? samples.acs_stretch : samples.sync_stretch;
  const StepSamples acs = cut_channels(samples.acs, samples.acs_stretch,
                                       absolute ? std::vector{recipe.reference}
                                                : std::vector{recipe.reference, recipe.sync_acs});
  const StepSamples sync =
      absolute ? StepSamples{} : cut_channels(*samples.sync, stretch, {recipe.sync_dau});
  const StepSamples dut = cut_channels(sensor, stretch, names);
  if (!absolute) {
    flag_unknown_clock(*samples.sync, stretch, flags);
  } else if (recipe.systematic.acs_delay_s <= 0.0) { // counts for the clock of the ACS too, which
                                                     // describes no uncertainty of its own
    flag_unknown_clock(samples.acs, stretch, flags);
  }
  flag_unknown_clock(sensor, stretch, flags);
  const bool anything = !dut.stamps_ns.empty();
  const auto evaluated =
      !anything  ? fail(analysis::ErrorCode::too_few_samples,
                        sensor.source() + ": no sample with a trusted stamp lies in the step")
      : absolute ? by_absolute_time(recipe, step, samples, acs, sensor, dut, names)
                 : by_sync_beside(recipe, step, samples, acs, sync, sensor, dut, names);
  const std::string data_sha256 = digest_of({&acs, &sync, &dut});
  std::vector<wire::CalibrationResult> results;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!evaluated) {
      results.push_back(result_head(recipe, step, names[i].text()));
      results.back().problem(evaluated.error().message);
      continue;
    }
    wire::CalibrationResult result =
        point_result(recipe, step, names[i], evaluated->points[i], evaluated->common_fits);
    result.unit(ratio_unit(samples.acs, recipe.reference.channel, sensor, names[i].channel));
    result.samples().push_back(samples_message(samples.acs, acs, samples.acs_stretch));
    if (!absolute) {
      result.samples().push_back(samples_message(*samples.sync, sync, stretch));
    }
    result.samples().push_back(samples_message(sensor, dut, stretch));
    for (const wire::SourceSamples& part : result.samples()) {
      result.lost(result.lost() + part.lost());
    }
    result.flags() = flags;
    result.data_sha256(data_sha256);
    add_monte_carlo_check(recipe, evaluated->points[i], evaluated->common_fits, result);
    results.push_back(std::move(result));
  }
  return results;
}

} // namespace

std::vector<wire::CalibrationResult>
evaluate_apart_step(const Recipe& recipe, const RecipeStep& step, const ApartStep& samples,
                    const std::vector<const SourceRecord*>& sensors,
                    const std::vector<std::string>& flags) {
  std::vector<wire::CalibrationResult> results;
  for (const SourceRecord* sensor : sensors) {
    auto of_sensor = evaluate_sensor(recipe, step, samples, *sensor, flags);
    results.insert(results.end(), std::make_move_iterator(of_sensor.begin()),
                   std::make_move_iterator(of_sensor.end()));
  }
  return results;
}

} // namespace dyncal::services
