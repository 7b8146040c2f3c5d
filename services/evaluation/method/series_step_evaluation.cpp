#include "services/evaluation/method/series_step_evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>

#include <fmt/format.h>

#include "analysis/method/series_stamping.hpp"
#include "services/contract/digest.hpp"

namespace dyncal::services {
namespace {

SeriesStepOutput without_result(const Recipe& recipe, const RecipeStep& step,
                                analysis::StartKind start, const std::string& problem) {
  SeriesStepOutput output{{}, std::nullopt, start};
  for (const ChannelName& channel : recipe.dut) {
    output.results.push_back(result_head(recipe, step, channel.text()));
    output.results.back().problem(problem);
  }
  return output;
}

// Shots whose series have the length and the rate that most have, and whose records have the
// channels.
std::vector<ShotRecord::Shot> of_usual_length(const std::vector<ShotRecord::Shot>& shots,
                                              std::size_t series_channels,
                                              std::size_t trace_channels,
                                              std::vector<std::string>& flags) {
  const auto form = [](const ShotRecord::Shot& shot) {
    return std::pair(shot.series->sample_count(), shot.series->interval_s());
  };
  std::map<std::pair<std::uint32_t, double>, std::size_t> forms;
  for (const ShotRecord::Shot& shot : shots) {
    ++forms[form(shot)];
  }
  const auto usual = std::max_element(
      forms.begin(), forms.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<ShotRecord::Shot> chosen;
  for (const ShotRecord::Shot& shot : shots) {
    if (form(shot) == usual->first && shot.series->channel_count() >= series_channels &&
        shot.trace->channel_count() >= trace_channels) {
      chosen.push_back(shot);
    }
  }
  if (chosen.size() < shots.size()) {
    flags.push_back(fmt::format("{} shots of another length, rate or number of channels left out",
                                shots.size() - chosen.size()));
  }
  return chosen;
}

std::string digest_of(const StepSamples& acs, const std::vector<ShotRecord::Shot>& shots) {
  Digest digest;
  digest.add(acs.stamps_ns.data(), acs.stamps_ns.size() * sizeof(std::int64_t));
  for (const auto& column : acs.columns) {
    digest.add(column.data(), column.size() * sizeof(double));
  }
  for (const ShotRecord::Shot& shot : shots) {
    for (const wire::TriggeredRecord* record : {shot.trace, shot.series}) {
      const std::array axis{record->first_sample_s(), record->interval_s()};
      digest.add(axis.data(), sizeof(axis));
      digest.add(record->values().data(), record->values().size() * sizeof(double));
    }
  }
  return digest.hex();
}

wire::SourceSamples shots_message(const SourceRecord& source,
                                  const std::vector<ShotRecord::Shot>& shots, bool series) {
  wire::SourceSamples samples;
  samples.source(source.source());
  std::uint64_t used = 0;
  for (const ShotRecord::Shot& shot : shots) {
    used += series ? shot.series->sample_count() : shot.trace->sample_count();
  }
  samples.used(used);
  samples.first_stamp_ns(shots.front().trace->trigger_utc_ns());
  samples.last_stamp_ns(shots.back().trace->trigger_utc_ns());
  return samples;
}

// When each shot's series began, relative to their mean, from the phase of its H.
analysis::StartLatency start_latency(const analysis::SeriesStampingResult& result,
                                     double angular_hz) {
  std::vector<double> offsets_s;
  double u2_s2 = 0.0;
  const analysis::SeriesChannelResult& pilot = result.channels.front();
  for (const analysis::Repetition& shot : pilot.shots) {
    offsets_s.push_back(std::arg(shot.h / pilot.mean.h) / angular_hz);
    u2_s2 +=
        std::pow(shot.u_random_phase_rad / angular_hz, 2) / static_cast<double>(pilot.shots.size());
  }
  return analysis::judge_start_latency(offsets_s, std::sqrt(u2_s2), 1.0 / result.rate.real_rate_hz);
}

std::vector<analysis::Contribution> budget_of(const analysis::SeriesStampingResult& result,
                                              const analysis::SeriesChannelResult& channel) {
  const analysis::Repetition& first = channel.shots.front();
  const auto rest = [](double u, double common) {
    return std::sqrt(std::max(0.0, u * u - common * common));
  };
  std::vector<analysis::Contribution> rows{
      {.kind = analysis::ContributionKind::shots,
       .degrees_of_freedom = channel.shots.size() > 1
                                 ? static_cast<double>(channel.shots.size() - 1)
                                 : analysis::infinite_degrees_of_freedom,
       .u_magnitude_rel =
           rest(channel.mean.u_magnitude / channel.mean.magnitude, first.u_common_magnitude_rel),
       .u_phase_rad = rest(channel.mean.u_phase_rad, first.u_common_phase_rad)}};
  rows.insert(rows.end(), result.common_budget.begin(), result.common_budget.end());
  return rows;
}

// What the evaluation needs of the shots; the spans are those of the records.
void add_shots(const std::vector<ShotRecord::Shot>& shots, std::size_t sync,
               const std::vector<std::size_t>& places, analysis::SeriesStampingInput& input) {
  input.nominal_rate_hz = 1.0 / shots.front().series->interval_s();
  for (const ShotRecord::Shot& shot : shots) {
    analysis::SeriesShot one{
        shot.trace->first_sample_s(), shot.trace->interval_s(), channel_of(*shot.trace, sync), {}};
    for (const std::size_t place : places) {
      one.series.push_back(channel_of(*shot.series, place));
    }
    input.shots.push_back(std::move(one));
  }
}

void add_corrections(const Recipe& recipe, analysis::SeriesStampingInput& input) {
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.dso_delay_s = recipe.dso_delay_s;
  input.u_dso_delay_s = recipe.u_dso_delay_s;
  input.reference_magnitude_rel = recipe.systematic.reference_magnitude_rel;
  input.reference_phase_rad = recipe.systematic.reference_phase_rad;
  input.acs_delay_s = recipe.systematic.acs_delay_s;
  input.reference_delay_s = recipe.reference_delay_s;
  input.correct_trigger_phase = recipe.trigger_phase_correction;
}

struct Judged {
  analysis::SeriesStampingResult result;
  analysis::StartLatency start;
};

// Evaluates, judges the start, and evaluates again when that must be corrected.
analysis::Expected<Judged> evaluate_and_judge(analysis::SeriesStampingInput& input,
                                              analysis::StartKind start_so_far) {
  auto evaluated = analysis::evaluate_series_stamping(input);
  if (!evaluated) {
    return fail(evaluated.error());
  }
  analysis::StartLatency start = start_latency(*evaluated, input.frequency.angular());
  if (start.kind == analysis::StartKind::undecided) {
    start.kind = start_so_far;
  }
  if (start.kind == analysis::StartKind::uniform) {
    const double sample_s = 1.0 / evaluated->rate.real_rate_hz;
    input.start_latency_s = 0.5 * sample_s;
    input.start_scatter_s = sample_s / std::sqrt(12.0);
    evaluated = analysis::evaluate_series_stamping(input);
  }
  return evaluated.map([&](analysis::SeriesStampingResult& result) {
    return Judged{std::move(result), start};
  });
}

void add_numbers(const Recipe& recipe, const Judged& judged,
                 const analysis::SeriesChannelResult& channel, wire::CalibrationResult& result) {
  result.valid(true);
  result.magnitude(channel.mean.magnitude);
  result.u_magnitude(channel.mean.u_magnitude);
  result.phase_rad(channel.mean.phase_rad);
  result.u_phase_rad(channel.mean.u_phase_rad);
  const analysis::NominalFrequency& rate = judged.result.rate;
  result.sample_rate_hz(rate.real_rate_hz);
  result.u_sample_rate_hz(
      std::hypot(rate.u_real_rate_hz, recipe.u_acs_rate_rel * rate.real_rate_hz));
  result.series_start(analysis::to_string(judged.start.kind));
  result.series_start_scatter_s(judged.start.scatter_s);
  result.fits().push_back(fit_message(judged.result.reference));
  result.fits().push_back(fit_message(judged.result.sync_acs));
  add_budget(budget_of(judged.result, channel), result);
}

// What a reader of the result should know of its shots.
void add_flags(const Recipe& recipe, const Judged& judged, std::size_t shots,
               std::vector<std::string>& flags) {
  if (shots < recipe.shots) {
    flags.push_back(fmt::format("{} of {} shots", shots, recipe.shots));
  }
  if (judged.start.kind == analysis::StartKind::undecided) {
    flags.push_back(fmt::format("start of the series: {}", analysis::to_string(judged.start.kind)));
  }
  if (!recipe.trigger_phase_correction) {
    flags.emplace_back("the phase of the trigger is not corrected");
  }
}

} // namespace

SeriesStepOutput evaluate_series_step(const Recipe& recipe, const RecipeStep& step,
                                      const SeriesStepRecords& records,
                                      analysis::StartKind start_so_far,
                                      std::vector<std::string> flags) {
  const auto& [acs, acs_stretch, oscilloscope, sensor, all_shots] = records;
  if (all_shots.empty()) {
    return without_result(recipe, step, start_so_far,
                          fmt::format("no shot of {} and {} was triggered in this step",
                                      oscilloscope.source(), sensor.source()));
  }
  const StepSamples acs_samples =
      cut(acs, acs_stretch,
          {*acs.channel(recipe.reference.channel), *acs.channel(recipe.sync_acs.channel)});
  analysis::SeriesStampingInput input{
      .frequency = step.frequency,
      .acs_stamps_ns = acs_samples.stamps_ns,
      .reference = {recipe.reference.text(), acs_samples.columns[0], 0.0},
      .sync_acs = {recipe.sync_acs.text(), acs_samples.columns[1], 0.0}};
  add_corrections(recipe, input);
  std::vector<std::size_t> places;
  for (const ChannelName& channel : recipe.dut) {
    input.channels.push_back(channel.text());
    places.push_back(*sensor.channel(channel.channel));
  }
  const std::size_t sync = *oscilloscope.channel(recipe.sync_dau.channel);
  const auto shots = of_usual_length(all_shots, *std::max_element(places.begin(), places.end()) + 1,
                                     sync + 1, flags);
  if (shots.empty()) {
    return without_result(recipe, step, start_so_far,
                          "the records of the shots lack a channel that was described");
  }
  add_shots(shots, sync, places, input);
  auto judged = evaluate_and_judge(input, start_so_far);
  if (!judged) {
    return without_result(recipe, step, start_so_far, judged.error().message);
  }
  add_flags(recipe, *judged, shots.size(), flags);

  SeriesStepOutput output{{}, judged->result.rate, judged->start.kind};
  const std::string data_sha256 = digest_of(acs_samples, shots);
  for (std::size_t i = 0; i < recipe.dut.size(); ++i) {
    wire::CalibrationResult result = result_head(recipe, step, recipe.dut[i].text());
    add_numbers(recipe, *judged, judged->result.channels[i], result);
    result.unit(ratio_unit(acs, recipe.reference.channel, sensor, recipe.dut[i].channel));
    result.samples().push_back(samples_message(acs, acs_samples, acs_stretch));
    result.samples().push_back(shots_message(oscilloscope, shots, false));
    result.samples().push_back(shots_message(sensor, shots, true));
    result.lost(result.samples()[0].lost());
    result.flags() = flags;
    result.data_sha256(data_sha256);
    output.results.push_back(std::move(result));
  }
  return output;
}

} // namespace dyncal::services
