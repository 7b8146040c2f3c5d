#include "services/evaluation/step_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "services/bench/digest.hpp"
#include "services/bench/unit.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

// One source's part of a step: the stamps and the columns asked for, cleaned, each sample once.
struct Series {
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::vector<double>> columns;
  std::uint64_t not_trusted = 0;
};

Series cut(const SourceRecord& record, const StretchOfTime& stretch, const std::vector<std::size_t>& channels) {
  Series series;
  series.columns.resize(channels.size());
  std::vector<std::span<const double>> columns;
  for (const std::size_t channel : channels) {
    columns.push_back(record.column(channel));
  }
  const auto stamps = record.stamps_ns();
  const auto flags = record.flags();
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (stamps[i] < stretch.begin_ns || stamps[i] > stretch.end_ns) {
      continue;
    }
    const bool increasing = series.stamps_ns.empty() || stamps[i] > series.stamps_ns.back();
    const bool measured = std::all_of(columns.begin(), columns.end(), [&](auto column) { return std::isfinite(column[i]); });
    if (flags[i] != 0 || !increasing || !measured) {
      ++series.not_trusted;
      continue;
    }
    series.stamps_ns.push_back(stamps[i]);
    for (std::size_t channel = 0; channel < columns.size(); ++channel) {
      series.columns[channel].push_back(columns[channel][i]);
    }
  }
  return series;
}

std::string digest_of(const Series& acs, const Series& dau) {
  Digest digest;
  for (const Series* series : {&acs, &dau}) {
    digest.add(series->stamps_ns.data(), series->stamps_ns.size() * sizeof(std::int64_t));
    for (const auto& column : series->columns) {
      digest.add(column.data(), column.size() * sizeof(double));
    }
  }
  return digest.hex();
}

SourceSamples samples_message(const SourceRecord& record, const Series& series, const StretchOfTime& stretch) {
  SourceSamples samples;
  samples.source(record.source());
  samples.used(series.stamps_ns.size());
  samples.lost(record.lost_between(stretch.begin_ns, stretch.end_ns));
  samples.not_trusted(series.not_trusted);
  samples.first_ns(series.stamps_ns.empty() ? 0 : series.stamps_ns.front());
  samples.last_ns(series.stamps_ns.empty() ? 0 : series.stamps_ns.back());
  return samples;
}

SineFit fit_message(const analysis::SeriesFit& series) {
  SineFit message;
  message.series(series.series);
  message.frequency_hz(series.frequency.hz());
  message.u_frequency_hz(series.u_frequency_hz);
  message.reference_ns(series.reference_ns);
  message.sine(series.fit.sine);
  message.cosine(series.fit.cosine);
  message.offset(series.fit.offset);
  message.u_sine(std::sqrt(series.fit.covariance[0]));
  message.u_cosine(std::sqrt(series.fit.covariance[3]));
  message.u_offset(std::sqrt(series.fit.covariance[5]));
  message.residual_rms(std::sqrt(series.fit.rss / static_cast<double>(std::max<std::uint64_t>(series.fit.samples, 1))));
  message.samples(series.fit.samples);
  return message;
}

CalibrationResult result_head(const Recipe& recipe, const RecipeStep& step, const std::string& channel) {
  CalibrationResult result;
  result.bench(recipe.bench);
  result.run(recipe.run);
  result.channel(channel);
  result.step(step.step);
  result.repetition(step.repetition);
  result.frequency_text_hz(step.frequency_text_hz);
  result.frequency_hz(step.frequency.hz());
  result.level_m_s2(step.level_m_s2);
  result.valid(false);
  result.magnitude(nan_value);
  result.u_magnitude(nan_value);
  result.phase_rad(nan_value);
  result.u_phase_rad(nan_value);
  result.software(software_version());
  result.recipe_sha256(recipe.sha256);
  return result;
}

// Output per input, as D-SI knows it: "\one" when both are the same.
std::string ratio_unit(const SourceRecord& acs, const std::string& reference, const SourceRecord& dau, const std::string& channel) {
  const std::string in = acs.description().channels()[*acs.channel(reference)].unit();
  const std::string out = dau.description().channels()[*dau.channel(channel)].unit();
  if (in == out) {
    return R"(\one)";
  }
  return in.empty() || out.empty() ? "" : fmt::format("({})/({})", short_form(out), short_form(in));
}

double resolution_of(const SourceRecord& record, std::size_t channel) {
  return record.description().channels()[channel].resolution();
}

void add_budget(const analysis::TransferPoint& point, CalibrationResult& result) {
  for (const analysis::Contribution& line : point.budget) {
    BudgetContribution message;
    message.name(line.name);
    message.distribution(line.distribution);
    message.degrees_of_freedom(line.degrees_of_freedom);
    message.u_magnitude_rel(line.u_magnitude_rel);
    message.u_phase_rad(line.u_phase_rad);
    result.budget().push_back(message);
  }
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
  const Series acs_series = cut(acs, acs_stretch, acs_channels);
  const Series dau_series = cut(dau, dau_stretch, dau_channels);

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
    add_budget(point, result);
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
