#include "services/evaluation/method/series_step_evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>

#include <fmt/core.h>

#include "analysis/method/series_stamping.hpp"
#include "analysis/uncertainty/found_resolution.hpp"
#include "services/contract/digest.hpp"
#include "services/evaluation/method/line_check.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/recipe/reference_correction.hpp"

namespace dyncal::services {
namespace {

SeriesStepOutput without_result(const SeriesStepInput& input, const std::string& problem) {
  return {results_without_value(input.task.step(), input.task.recipe->dut(), problem), std::nullopt,
          input.start_so_far};
}

// Shots whose series have the length and the rate that most have, and whose records have the
// channels.
std::vector<ShotRecord::Shot> of_usual_length(const std::vector<ShotRecord::Shot>& shots,
                                              std::size_t series_channels,
                                              std::size_t trace_channels,
                                              std::vector<Flag>& flags) {
  const auto form = [](const ShotRecord::Shot& shot) {
    return std::pair(shot.series->samples, shot.series->interval_s);
  };
  std::map<std::pair<std::size_t, double>, std::size_t> forms;
  for (const ShotRecord::Shot& shot : shots) {
    ++forms[form(shot)];
  }
  const auto usual = std::max_element(
      forms.begin(), forms.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<ShotRecord::Shot> chosen;
  for (const ShotRecord::Shot& shot : shots) {
    if (form(shot) == usual->first && shot.series->channels >= series_channels &&
        shot.trace->channels >= trace_channels) {
      chosen.push_back(shot);
    }
  }
  if (chosen.size() < shots.size()) {
    flags.push_back(
        {ResultFlag::shots_left_out, fmt::format("{} {}", shots.size() - chosen.size(),
                                                 to_string(ResultFlag::shots_left_out))});
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
    for (const TriggeredRecord* record : {shot.trace, shot.series}) {
      const std::array axis{record->first_sample_s, record->interval_s};
      digest.add(axis.data(), sizeof(axis));
      digest.add(record->values.data(), record->values.size() * sizeof(double));
    }
  }
  return digest.hex();
}

SourceSamples summary_of(const SourceRecord& source, const std::vector<ShotRecord::Shot>& shots,
                         const TriggeredRecord* ShotRecord::Shot::*record,
                         const ShotRecord::Loss& loss) {
  SourceSamples summary;
  summary.source = source.source();
  for (const ShotRecord::Shot& shot : shots) {
    summary.used += (shot.*record)->samples;
  }
  summary.unusable = loss.unusable_samples;
  summary.overflowed = loss.overflowed_samples;
  summary.first_stamp_ns = shots.front().trace->trigger_utc_ns;
  summary.last_stamp_ns = shots.back().trace->trigger_utc_ns;
  return summary;
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

std::vector<analysis::Contribution> budget_of(const analysis::SeriesChannelResult& channel) {
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
  rows.insert(rows.end(), channel.common_budget.begin(), channel.common_budget.end());
  return rows;
}

// What the evaluation needs of the shots; the spans are those of the records.
void add_shots(const std::vector<ShotRecord::Shot>& shots, std::size_t sync,
               const std::vector<std::size_t>& columns, analysis::SeriesStampingInput& input) {
  input.nominal_rate_hz = 1.0 / shots.front().series->interval_s;
  for (const ShotRecord::Shot& shot : shots) {
    analysis::SeriesShot one{
        shot.trace->first_sample_s, shot.trace->interval_s, shot.trace->channel(sync), {}};
    for (const std::size_t column : columns) {
      one.series.push_back(shot.series->channel(column));
    }
    input.shots.push_back(std::move(one));
  }
}

void add_corrections(const Recipe& recipe, analysis::SeriesStampingInput& input) {
  const auto& roles = std::get<SeriesRoles>(recipe.roles);
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.dso_delay_s = roles.dso_delay_s;
  input.u_dso_delay_s = roles.u_dso_delay_s;
  input.u_dso_rate_rel = roles.u_dso_rate_rel;
  input.reference_magnitude_rel = recipe.systematic.reference_magnitude_rel;
  input.reference_phase_rad = recipe.systematic.reference_phase_rad;
  input.acs_delay_s = recipe.systematic.acs_delay_s;
  input.reference_delay_s = recipe.reference_delay_s;
  input.correct_trigger_phase = roles.trigger_phase_correction;
}

struct EvaluatedSeries {
  analysis::SeriesStampingResult result;
  analysis::StartLatency start;
};

// Evaluates, decides how the series start, and evaluates again when that must be corrected.
analysis::Expected<EvaluatedSeries> evaluate_series(analysis::SeriesStampingInput& input,
                                                    analysis::StartKind start_so_far) {
  auto evaluated = analysis::evaluate_series_stamping(input);
  if (!evaluated) {
    return fail(evaluated.error());
  }
  analysis::StartLatency start = start_latency(*evaluated, input.frequency.angular());
  start.kind = start.kind_after(start_so_far);
  if (start.kind == analysis::StartKind::uniform) {
    const double sample_s = 1.0 / evaluated->rate.real_rate_hz;
    input.start_latency_s = 0.5 * sample_s;
    input.start_scatter_s = sample_s / std::sqrt(12.0);
    evaluated = analysis::evaluate_series_stamping(input);
  }
  return evaluated.map([&](analysis::SeriesStampingResult& result) {
    return EvaluatedSeries{std::move(result), start};
  });
}

void add_value(const SeriesRoles& roles, const EvaluatedSeries& evaluated,
               const analysis::SeriesChannelResult& channel, StepResult& result) {
  result.valid = true;
  result.magnitude = channel.mean.magnitude;
  result.u_magnitude = channel.mean.u_magnitude;
  result.phase_rad = channel.mean.phase_rad;
  result.u_phase_rad = channel.mean.u_phase_rad;
  const analysis::NominalFrequency& rate = evaluated.result.rate;
  result.series = SeriesFinding{
      rate.real_rate_hz, std::hypot(rate.u_real_rate_hz, roles.u_acs_rate_rel * rate.real_rate_hz),
      to_string(evaluated.start.kind), evaluated.start.scatter_s};
  result.fits = {evaluated.result.reference, evaluated.result.sync_acs};
  result.budget = budget_of(channel);
}

// What a reader of the result should know of its shots.
void add_flags(const SeriesStepInput& input, const EvaluatedSeries& evaluated, std::size_t shots,
               std::vector<Flag>& flags) {
  const auto& roles = std::get<SeriesRoles>(input.task.recipe->roles);
  if (shots < roles.shots) {
    flags.push_back({ResultFlag::shots_missing, fmt::format("{} of {} {}", shots, roles.shots,
                                                            to_string(ResultFlag::shots_missing))});
  }
  if (input.lost.traces.records > 0) {
    flags.push_back(flag_of_source(ResultFlag::records_lost, input.oscilloscope.source()));
  }
  if (input.lost.series.records > 0) {
    flags.push_back(flag_of_source(ResultFlag::records_lost, input.sensor.source()));
  }
  if (evaluated.start.kind == analysis::StartKind::undecided) {
    flags.push_back(flag_with_reason(ResultFlag::start_undecided, to_string(evaluated.start.kind)));
  }
  if (!roles.trigger_phase_correction) {
    flags.push_back(make_flag(ResultFlag::trigger_phase_not_corrected));
  }
}

std::vector<std::size_t> columns_of(const SourceRecord& sensor,
                                    const std::vector<ChannelName>& dut) {
  std::vector<std::size_t> columns;
  columns.reserve(dut.size());
  for (const ChannelName& channel : dut) {
    columns.push_back(*sensor.channel(channel.channel));
  }
  return columns;
}

analysis::SeriesStampingInput input_of(const StepTask& task, const SelectedChannels& acs,
                                       const std::vector<ShotRecord::Shot>& shots, std::size_t sync,
                                       const std::vector<std::size_t>& columns) {
  // The quantisation of the ACS is not a row of this method's budget.
  analysis::ChannelSamples reference = acs.channel(0);
  analysis::ChannelSamples sync_acs = acs.channel(1);
  reference.resolution = 0.0;
  sync_acs.resolution = 0.0;
  analysis::SeriesStampingInput input{.frequency = task.step().frequency,
                                      .acs_stamps_ns = acs.stamps_ns(),
                                      .reference = reference,
                                      .sync_acs = sync_acs};
  add_corrections(*task.recipe, input);
  for (const ChannelName& channel : task.recipe->dut()) {
    input.channels.push_back(channel.text());
  }
  add_shots(shots, sync, columns, input);
  return input;
}

std::vector<std::int64_t> series_stamps_ns(const std::vector<ShotRecord::Shot>& shots,
                                           double real_rate_hz) {
  std::vector<std::int64_t> stamps_ns(shots.front().series->samples);
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    stamps_ns[i] = std::llround(static_cast<double>(i) * 1e9 / real_rate_hz);
  }
  return stamps_ns;
}

// What every shot shows of the lines, of which none may tell any from the excitation.
ChannelLines lines_of_shots(const SeriesStepInput& input,
                            const std::vector<ShotRecord::Shot>& shots,
                            const EvaluatedSeries& evaluated, const ChannelName& channel,
                            std::size_t column) {
  const std::vector<std::int64_t> stamps_ns =
      series_stamps_ns(shots, evaluated.result.rate.real_rate_hz);
  ChannelLines lines;
  for (const ShotRecord::Shot& shot : shots) {
    const std::span<const double> values[] = {shot.series->channel(column)};
    const analysis::Frequency& frequency = evaluated.result.sync_acs.frequency;
    const auto fit = analysis::fit_sine(frequency, 0, stamps_ns, values);
    if (!fit) {
      continue;
    }
    ChannelLines of_shot =
        check_lines(*input.task.recipe, {"the sensor"},
                    {.channel = channel.text(), .frequency = frequency, .fit = fit->front()},
                    stamps_ns, values[0]);
    if (lines.channel.empty()) {
      lines = std::move(of_shot);
    } else {
      lines.measured.insert(lines.measured.end(), of_shot.measured.begin(), of_shot.measured.end());
    }
  }
  return lines;
}

// The first shot in which something is found speaks for the step, or else the very first.
SignalCheck check_shots(const SeriesStepInput& input, const std::vector<ShotRecord::Shot>& shots,
                        const EvaluatedSeries& evaluated, const ChannelName& channel,
                        std::size_t column) {
  const std::vector<std::int64_t> stamps_ns =
      series_stamps_ns(shots, evaluated.result.rate.real_rate_hz);
  const drivers::ChannelDescription& description = input.sensor.description().channels[column];
  std::optional<SignalCheck> first;
  for (const ShotRecord::Shot& shot : shots) {
    const std::span<const double> values = shot.series->channel(column);
    analysis::SignalExpectation expected = expectation_of(description);
    if (!(expected.resolution > 0.0)) {
      expected.resolution = analysis::found_resolution(values);
    }
    SignalCheck check =
        check_signal(channel.text(), analysis::measure_integrity(input.task.step().frequency,
                                                                 stamps_ns, values, expected));
    if (!check.flags.empty()) {
      return check;
    }
    if (!first) {
      first = std::move(check);
    }
  }
  return *first;
}

std::vector<StepResult> results_of(const SeriesStepInput& input, const SelectedChannels& acs,
                                   const std::vector<ShotRecord::Shot>& shots,
                                   const EvaluatedSeries& evaluated,
                                   const std::vector<Flag>& flags) {
  const auto& roles = std::get<SeriesRoles>(input.task.recipe->roles);
  const StepTask task{input.task.recipe, input.task.index, flags};
  const StepInput made_of{
      .dut = roles.dut,
      .reference_unit = acs.unit(0),
      .units = {},
      .samples = {acs.summary(),
                  summary_of(input.oscilloscope, shots, &ShotRecord::Shot::trace,
                             input.lost.traces),
                  summary_of(input.sensor, shots, &ShotRecord::Shot::series, input.lost.series)},
      .data_sha256 = digest_of(acs.samples(), shots),
      .common = {},
      .first_dut = {}};
  const SignalCheck reference = check_signal(evaluated.result.reference);
  SignalCheck sync = check_signal(evaluated.result.sync_acs);
  sync.refusal.clear(); // it carries phase only
  const std::vector<ChannelLines> common_lines{
      check_lines(*task.recipe, {"the reference"}, evaluated.result.reference, acs, 0),
      check_lines(*task.recipe, {"the ACS sync", false}, evaluated.result.sync_acs, acs, 1)};
  std::vector<StepResult> results;
  for (std::size_t i = 0; i < roles.dut.size(); ++i) {
    StepResult result = result_head(task.step(), roles.dut[i]);
    add_value(roles, evaluated, evaluated.result.channels[i], result);
    const std::size_t column = *input.sensor.channel(roles.dut[i].channel);
    result.unit = ratio_unit(acs.unit(0), input.sensor.description().channels[column].unit);
    add_input(task, made_of, result);
    add_check(reference, result);
    add_check(sync, result);
    add_check(check_shots(input, shots, evaluated, roles.dut[i], column), result);
    std::vector<ChannelLines> lines = common_lines;
    lines.push_back(lines_of_shots(input, shots, evaluated, roles.dut[i], column));
    add_lines(std::move(lines), result);
    results.push_back(std::move(result));
  }
  return results;
}

} // namespace

SeriesStepOutput evaluate_series_step(const SeriesStepInput& step) {
  const auto& roles = std::get<SeriesRoles>(step.task.recipe->roles);
  if (step.shots.empty()) {
    return without_result(step, fmt::format("no shot of {} and {} was triggered in this step",
                                            step.oscilloscope.source(), step.sensor.source()));
  }
  const SelectedChannels acs(step.acs, {roles.reference, roles.sync_acs});
  const std::vector<std::size_t> columns = columns_of(step.sensor, roles.dut);
  const std::size_t sync = *step.oscilloscope.channel(roles.sync_dso.channel);
  std::vector<Flag> flags = step.task.flags;
  const auto shots = of_usual_length(
      step.shots, *std::max_element(columns.begin(), columns.end()) + 1, sync + 1, flags);
  if (shots.empty()) {
    return without_result(step, "the records of the shots lack a channel that was described");
  }
  analysis::SeriesStampingInput input = input_of(step.task, acs, shots, sync, columns);
  const auto reference = reference_response(*step.task.recipe, step.task.step());
  if (!reference) {
    return without_result(step, reference.error().message);
  }
  input.reference_response = *reference;
  const auto evaluated = evaluate_series(input, step.start_so_far);
  if (!evaluated) {
    return without_result(step, evaluated.error().message);
  }
  add_flags(step, *evaluated, shots.size(), flags);
  return {results_of(step, acs, shots, *evaluated, flags), evaluated->result.rate,
          evaluated->start.kind};
}

} // namespace dyncal::services
