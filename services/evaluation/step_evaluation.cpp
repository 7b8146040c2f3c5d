#include "services/evaluation/step_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "services/bench/digest.hpp"
#include "services/evaluation/step_message.hpp"

namespace dyncal::services {
namespace {

std::string digest_of(const StepSamples& acs, const StepSamples& dau) {
  Digest digest;
  for (const StepSamples* series : {&acs, &dau}) {
    digest.add(series->stamps_ns.data(), series->stamps_ns.size() * sizeof(std::int64_t));
    for (const auto& column : series->columns) {
      digest.add(column.data(), column.size() * sizeof(double));
    }
  }
  return digest.hex();
}

double resolution_of(const SourceRecord& record, std::size_t channel) {
  return record.description().channels()[channel].resolution();
}

analysis::Expected<analysis::AdcResponse> adc_response(const Recipe& recipe, const RecipeStep& step) {
  if (recipe.adc_calibration.empty()) {
    return analysis::AdcResponse{};
  }
  return analysis::adc_response_at(recipe.adc_calibration, step.frequency.hz());
}

} // namespace

std::vector<ChannelName> channels_under_calibration(const Recipe& recipe, const SourceRecord& dau) {
  if (!recipe.dut.empty() || !dau.described()) {
    return recipe.dut;
  }
  std::vector<ChannelName> names;
  for (const ChannelDescription& channel : dau.description().channels()) {
    const ChannelName name{dau.source(), channel.name()};
    const bool thermometer = channel.unit() == R"(\degreecelsius)" || channel.unit() == R"(\kelvin)";
    const bool analogue_input = channel.unit() == R"(\volt)";
    if (name != recipe.sync_dau && name != recipe.temperature && !thermometer && !analogue_input) {
      names.push_back(name);
    }
  }
  return names;
}

std::vector<CalibrationResult> results_of_missing_step(const Recipe& recipe, const RecipeStep& step, const SourceRecord& dau,
                                                       const std::string& problem) {
  std::vector<CalibrationResult> results;
  for (const ChannelName& channel : channels_under_calibration(recipe, dau)) {
    results.push_back(result_head(recipe, step, channel.text()));
    results.back().problem(problem);
  }
  return results;
}

std::vector<CalibrationResult> evaluate_step(const Recipe& recipe, const RecipeStep& step, const SourceRecord& acs,
                                             const StretchOfTime& acs_stretch, const SourceRecord& dau, const StretchOfTime& dau_stretch,
                                             const std::vector<std::string>& flags) {
  const std::vector<ChannelName> dut = channels_under_calibration(recipe, dau);
  const std::vector<std::size_t> acs_channels{*acs.channel(recipe.reference.channel), *acs.channel(recipe.sync_acs.channel)};
  std::vector<std::size_t> dau_channels{*dau.channel(recipe.sync_dau.channel)};
  for (const ChannelName& name : dut) {
    dau_channels.push_back(*dau.channel(name.channel));
  }
  const StepSamples acs_series = cut(acs, acs_stretch, acs_channels);
  const StepSamples dau_series = cut(dau, dau_stretch, dau_channels);

  const auto adc = adc_response(recipe, step);
  if (!adc) {
    return results_of_missing_step(recipe, step, dau, adc.error().message);
  }
  analysis::SampleStampingInput input{.frequency = step.frequency,
                                      .frequency_search_rel = recipe.frequency_search_rel,
                                      .acs_stamps_ns = acs_series.stamps_ns,
                                      .reference = {recipe.reference.text(), acs_series.columns[0], resolution_of(acs, acs_channels[0])},
                                      .sync_acs = {recipe.sync_acs.text(), acs_series.columns[1], resolution_of(acs, acs_channels[1])},
                                      .dau_stamps_ns = dau_series.stamps_ns,
                                      .sync_dau = {recipe.sync_dau.text(), dau_series.columns[0], resolution_of(dau, dau_channels[0])},
                                      .dut = {},
                                      .adc = *adc,
                                      .reference_delay_s = recipe.reference_delay_s,
                                      .systematic = recipe.systematic};
  for (std::size_t i = 0; i < dut.size(); ++i) {
    input.dut.push_back({dut[i].text(), dau_series.columns[i + 1], resolution_of(dau, dau_channels[i + 1])});
  }
  input.systematic.dau_tick_s = dau.description().tick_s();
  const auto evaluated = analysis::evaluate_sample_stamping(input);
  if (!evaluated) {
    return results_of_missing_step(recipe, step, dau, evaluated.error().message);
  }

  const std::string data_sha256 = digest_of(acs_series, dau_series);
  std::vector<CalibrationResult> results;
  for (std::size_t i = 0; i < dut.size(); ++i) {
    const analysis::TransferPoint& point = evaluated->points[i];
    CalibrationResult result = result_head(recipe, step, dut[i].text());
    result.valid(true);
    result.magnitude(point.magnitude);
    result.u_magnitude(point.u_magnitude);
    result.phase_rad(point.phase_rad);
    result.u_phase_rad(point.u_phase_rad);
    result.unit(ratio_unit(acs, recipe.reference.channel, dau, dut[i].channel));
    for (const analysis::SeriesFit* fit : {&evaluated->reference, &evaluated->sync_acs, &evaluated->sync_dau, &point.dut}) {
      result.fits().push_back(fit_message(*fit));
    }
    add_budget(point.budget, result);
    result.samples().push_back(samples_message(acs, acs_series, acs_stretch));
    result.samples().push_back(samples_message(dau, dau_series, dau_stretch));
    result.lost(result.samples()[0].lost() + result.samples()[1].lost());
    result.flags() = flags;
    result.data_sha256(data_sha256);
    results.push_back(std::move(result));
  }
  return results;
}

} // namespace dyncal::services
