#include "services/evaluation/method/sample_stamping_step_evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "services/evaluation/method/settled_part.hpp"
#include "services/evaluation/monte_carlo_check.hpp"
#include "services/evaluation/step_message.hpp"

namespace dyncal::services {
namespace {

// One source's samples of the step.
struct StepPart {
  const SourceRecord& record;
  StretchOfTime stretch;
  std::vector<std::size_t> channels;
  StepSamples samples;

  void cut_samples() { samples = cut(record, stretch, channels); }
  [[nodiscard]] analysis::ChannelSamples channel(std::size_t column,
                                                 const ChannelName& name) const {
    return {name.text(), samples.columns[column],
            record.description().channels()[channels[column]].resolution()};
  }
};

void leave_settling_out(const Recipe& recipe, const RecipeStep& step, StepPart& acs, StepPart& dau,
                        std::vector<std::string>& flags) {
  SettlingColumns sensor{dau.samples, 0, {}};
  for (std::size_t column = 1; column < dau.channels.size(); ++column) {
    sensor.settling.push_back(column);
  }
  const Settled settled =
      settled_part(step, recipe.frequency_search_rel, {acs.samples, 1, {0}}, sensor);
  flags.insert(flags.end(), settled.flags.begin(), settled.flags.end());
  for (StepPart* part : {&acs, &dau}) {
    part->stretch = without_settling(part->stretch, settled.settling_s, step.duration_s);
    part->cut_samples();
  }
}

} // namespace

analysis::Expected<analysis::AdcResponse> adc_response(const Recipe& recipe,
                                                       const RecipeStep& step) {
  if (recipe.adc_calibration.empty()) {
    return analysis::AdcResponse{};
  }
  return analysis::adc_response_at(recipe.adc_calibration, step.frequency.hz());
}

std::vector<ChannelName> channels_under_calibration(const Recipe& recipe, const SourceRecord& dau) {
  if (!recipe.dut.empty() || !dau.described()) {
    return recipe.dut;
  }
  std::vector<ChannelName> names;
  for (const wire::ChannelDescription& channel : dau.description().channels()) {
    const ChannelName name{dau.source(), channel.name()};
    const bool thermometer =
        channel.unit() == R"(\degreecelsius)" || channel.unit() == R"(\kelvin)";
    const bool analogue_input = channel.unit() == R"(\volt)";
    if (name != recipe.sync_dau && name != recipe.temperature && !thermometer && !analogue_input) {
      names.push_back(name);
    }
  }
  return names;
}

std::vector<wire::CalibrationResult> results_of_missing_step(const Recipe& recipe,
                                                             const RecipeStep& step,
                                                             const SourceRecord& dau,
                                                             const std::string& problem) {
  std::vector<wire::CalibrationResult> results;
  for (const ChannelName& channel : channels_under_calibration(recipe, dau)) {
    results.push_back(result_head(recipe, step, channel.text()));
    results.back().problem(problem);
  }
  return results;
}

std::vector<wire::CalibrationResult>
evaluate_step(const Recipe& recipe, const RecipeStep& step, const SourceRecord& acs,
              const StretchOfTime& acs_stretch, const SourceRecord& dau,
              const StretchOfTime& dau_stretch, const std::vector<std::string>& flags) {
  const std::vector<ChannelName> dut = channels_under_calibration(recipe, dau);
  StepPart acs_part{acs,
                    acs_stretch,
                    {*acs.channel(recipe.reference.channel), *acs.channel(recipe.sync_acs.channel)},
                    {}};
  StepPart dau_part{dau, dau_stretch, {*dau.channel(recipe.sync_dau.channel)}, {}};
  for (const ChannelName& name : dut) {
    dau_part.channels.push_back(*dau.channel(name.channel));
  }
  acs_part.cut_samples();
  dau_part.cut_samples();
  std::vector<std::string> all_flags = flags;
  if (recipe.settling_from_data) {
    leave_settling_out(recipe, step, acs_part, dau_part, all_flags);
  }

  const auto adc = adc_response(recipe, step);
  if (!adc) {
    return results_of_missing_step(recipe, step, dau, adc.error().message);
  }
  analysis::SampleStampingInput input{.frequency = step.frequency,
                                      .frequency_search_rel = recipe.frequency_search_rel,
                                      .acs_stamps_ns = acs_part.samples.stamps_ns,
                                      .reference = acs_part.channel(0, recipe.reference),
                                      .sync_acs = acs_part.channel(1, recipe.sync_acs),
                                      .dau_stamps_ns = dau_part.samples.stamps_ns,
                                      .sync_dau = dau_part.channel(0, recipe.sync_dau),
                                      .dut = {},
                                      .adc = *adc,
                                      .reference_delay_s = recipe.reference_delay_s,
                                      .systematic = recipe.systematic};
  for (std::size_t i = 0; i < dut.size(); ++i) {
    input.dut.push_back(dau_part.channel(i + 1, dut[i]));
  }
  input.systematic.dau_tick_s = dau.description().tick_s();
  const auto evaluated = analysis::evaluate_sample_stamping(input);
  if (!evaluated) {
    return results_of_missing_step(recipe, step, dau, evaluated.error().message);
  }

  const std::string data_sha256 = digest_of({&acs_part.samples, &dau_part.samples});
  const std::array common_fits{evaluated->reference, evaluated->sync_acs, evaluated->sync_dau};
  std::vector<wire::CalibrationResult> results;
  for (std::size_t i = 0; i < dut.size(); ++i) {
    wire::CalibrationResult result =
        point_result(recipe, step, dut[i], evaluated->points[i], common_fits);
    result.unit(ratio_unit(acs, recipe.reference.channel, dau, dut[i].channel));
    result.samples().push_back(samples_message(acs, acs_part.samples, acs_part.stretch));
    result.samples().push_back(samples_message(dau, dau_part.samples, dau_part.stretch));
    result.lost(result.samples()[0].lost() + result.samples()[1].lost());
    result.flags() = all_flags;
    result.data_sha256(data_sha256);
    add_monte_carlo_check(recipe, evaluated->points[i], common_fits, result);
    results.push_back(std::move(result));
  }
  return results;
}

} // namespace dyncal::services
