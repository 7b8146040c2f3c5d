#include "services/evaluation/method/series_step_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/core.h>

#include "analysis/base/phasor.hpp"
#include "analysis/method/series_stamping.hpp"
#include "services/evaluation/method/line_check.hpp"
#include "services/evaluation/method/reference_channel.hpp"
#include "services/evaluation/method/series_checks.hpp"
#include "services/evaluation/method/series_shots.hpp"
#include "services/evaluation/method/shape_check.hpp"
#include "services/evaluation/method/step_results.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double any_phase = std::numbers::pi / std::numbers::sqrt3; // nothing is known of it
constexpr double arithmetic = 1e-9; // of a sample interval: shots without noise differ by less

SeriesStepOutput without_result(const SeriesStepInput& input, const std::string& problem) {
  return {results_without_value(input.task.step(), input.task.recipe->dut(), problem),
          std::nullopt,
          input.start_so_far,
          {},
          {}};
}

struct JudgedStart {
  analysis::StartLatency latency;
  analysis::StartEvidence evidence;
};

// When each shot's series began, relative to their mean, from the phase of its H; without what
// noise did to its trigger, be that corrected or not.
JudgedStart start_latency(const analysis::SeriesStampingResult& result,
                          const analysis::SeriesStampingInput& input,
                          analysis::StartKind start_so_far) {
  const double angular_hz = input.frequency.angular();
  const std::vector<analysis::Repetition>& shots = result.channels.front().shots;
  std::vector<std::complex<double>> directions;
  std::complex<double> mean;
  double u2_s2 = 0.0;
  for (std::size_t j = 0; j < shots.size(); ++j) {
    const double trigger_rad = input.correct_trigger_phase ? 0.0 : result.trigger_phase_rad[j];
    directions.push_back(analysis::unit_phasor(shots[j].h) * std::polar(1.0, -trigger_rad));
    mean += directions.back();
    u2_s2 +=
        std::pow(shots[j].u_random_phase_rad / angular_hz, 2) / static_cast<double>(shots.size());
  }
  std::vector<double> offsets_s;
  offsets_s.reserve(directions.size());
  for (const std::complex<double>& direction : directions) {
    offsets_s.push_back(std::arg(direction * std::conj(mean)) / angular_hz);
  }
  const double sample_s = 1.0 / result.rate.real_rate_hz;
  const double u_s = std::max(std::sqrt(u2_s2), arithmetic * sample_s);
  const analysis::StartLatency start =
      analysis::judge_start_latency(offsets_s, u_s, sample_s, start_so_far);
  const double freedom = static_cast<double>(shots.size()) - 1.0;
  return {start, {shots.size(), freedom * start.scatter_s * start.scatter_s, u_s}};
}

// The row of the shots, and what they have in common. A mean that hardly stands out of its noise
// has a phase whose u is no sum of squares (repetitions.hpp): its row is what is left of it.
std::vector<analysis::Contribution> budget_of(const analysis::SeriesChannelResult& channel) {
  constexpr double weak = 10.0;
  const analysis::RepetitionMean& mean = channel.mean;
  analysis::Contribution shots{.kind = analysis::ContributionKind::shots,
                               .u_magnitude_rel = mean.independent_magnitude_rel.u,
                               .u_phase_rad = mean.independent_phase.u};
  if (mean.magnitude < weak * mean.u_magnitude) {
    shots.u_phase_rad = mean.u_independent_phase_rad;
  } else {
    shots.degrees_of_freedom = std::min(mean.independent_magnitude_rel.degrees_of_freedom,
                                        mean.independent_phase.degrees_of_freedom);
  }
  std::vector<analysis::Contribution> rows{shots};
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
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.dso_delay_s = recipe.series.dso_delay_s;
  input.u_dso_delay_s = recipe.series.u_dso_delay_s;
  input.u_dso_rate_rel = recipe.series.u_dso_rate_rel;
  input.reference_magnitude_rel = recipe.systematic.reference_magnitude_rel;
  input.reference_phase_rad = recipe.systematic.reference_phase_rad;
  input.acs_delay_s = recipe.systematic.acs_delay_s;
  input.reference_delay_s = recipe.reference_delay_s;
  input.correct_trigger_phase = recipe.series.trigger_phase_correction;
}

struct EvaluatedSeries {
  analysis::SeriesStampingResult result;
  analysis::StartLatency start;
  analysis::StartEvidence start_evidence;
};

// Evaluates, and decides how the series start.
analysis::Expected<EvaluatedSeries> evaluate_series(const analysis::SeriesStampingInput& input,
                                                    analysis::StartKind start_so_far) {
  DYNCAL_TRY(auto evaluated, analysis::evaluate_series_stamping(input));
  const JudgedStart start = start_latency(evaluated, input, start_so_far);
  const double sample_s = 1.0 / evaluated.rate.real_rate_hz;
  DYNCAL_TRY(analysis::apply_start(start.latency, sample_s, evaluated.sync_acs.frequency.angular(),
                                   evaluated));
  return EvaluatedSeries{std::move(evaluated), start.latency, start.evidence};
}

double u_phase_of(const std::vector<analysis::Contribution>& budget) {
  double u_phase_rad = 0.0;
  for (const analysis::Contribution& row : budget) {
    u_phase_rad = std::hypot(u_phase_rad, row.u_phase_rad);
  }
  return std::min(any_phase, u_phase_rad);
}

void add_value(const SeriesSettings& settings, const EvaluatedSeries& evaluated,
               const SelectedChannels& acs, const analysis::SeriesChannelResult& channel,
               StepResult& result) {
  double u_magnitude_rel = 0.0;
  result.valid = true;
  result.magnitude = channel.mean.magnitude;
  result.phase_rad = channel.mean.phase_rad;
  const analysis::NominalFrequency& rate = evaluated.result.rate;
  result.series =
      SeriesFinding{rate.real_rate_hz,
                    std::hypot(rate.u_real_rate_hz, settings.u_acs_rate_rel * rate.real_rate_hz),
                    to_string(evaluated.start.kind), evaluated.start.scatter_s};
  result.fits = {excitation_fit(acs, evaluated.result.reference), evaluated.result.sync_acs};
  result.budget = budget_of(channel);
  for (const analysis::Contribution& row : result.budget) {
    u_magnitude_rel = std::hypot(u_magnitude_rel, row.u_magnitude_rel);
  }
  result.u_magnitude = u_magnitude_rel * channel.mean.magnitude;
  result.u_phase_rad = u_phase_of(result.budget);
}

// What a reader of the result should know of its shots.
void add_flags(const SeriesStepInput& input, const EvaluatedSeries& evaluated, std::size_t shots,
               std::vector<Flag>& flags) {
  const SeriesSettings& planned = input.task.recipe->series;
  if (shots < planned.shots) {
    flags.push_back({ResultFlag::shots_missing, fmt::format("{} of {} {}", shots, planned.shots,
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
  if (!planned.trigger_phase_correction) {
    flags.push_back(make_flag(ResultFlag::trigger_phase_not_corrected));
  }
}

std::map<std::string, analysis::StepBend> bends_of(const analysis::SeriesStampingResult& result) {
  std::map<std::string, analysis::StepBend> bends;
  for (const analysis::SeriesChannelResult& channel : result.channels) {
    if (channel.agreement) {
      bends.insert_or_assign(
          channel.channel,
          analysis::StepBend{result.sync_acs.frequency.angular(), channel.agreement->bend});
    }
  }
  return bends;
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
                                       analysis::ChannelSamples reference,
                                       const std::vector<ShotRecord::Shot>& shots, std::size_t sync,
                                       const std::vector<std::size_t>& columns) {
  // The quantisation of the ACS is not a row of this method's budget.
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

StepInput made_of(const SeriesStepInput& input, const SelectedChannels& acs,
                  const std::vector<ShotRecord::Shot>& shots) {
  return {.dut = input.task.recipe->dut(),
          .reference_unit = excitation_unit(acs),
          .units = {},
          .samples = {acs.summary(),
                      summary_of_shots(input.oscilloscope, shots, &ShotRecord::Shot::trace,
                                       input.lost.traces),
                      summary_of_shots(input.sensor, shots, &ShotRecord::Shot::series,
                                       input.lost.series)},
          .data_sha256 = digest_of_shots(acs.samples(), shots),
          .common = {},
          .first_dut = {}};
}

std::vector<StepResult> results_of(const SeriesStepInput& input, const SelectedChannels& acs,
                                   const std::vector<ShotRecord::Shot>& shots,
                                   const EvaluatedSeries& evaluated,
                                   const std::vector<Flag>& flags) {
  const RoleNames& roles = input.task.recipe->roles;
  const StepTask task{input.task.recipe, input.task.index, flags};
  const StepInput of_step = made_of(input, acs, shots);
  const CheckedShots checked{task, input.oscilloscope, input.sensor, shots, evaluated.result};
  const SignalCheck reference = check_signal(evaluated.result.reference);
  SignalCheck sync = check_signal(evaluated.result.sync_acs);
  sync.refusal.clear(); // it carries phase only
  const SignalCheck traces = check_traces(checked, roles.sync_sensor);
  const std::vector<ChannelLines> common_lines{
      check_lines(*task.recipe, {"the reference"}, evaluated.result.reference, acs, 0),
      check_lines(*task.recipe, {"the ACS sync", false}, evaluated.result.sync_acs, acs, 1)};
  std::vector<StepResult> results;
  for (std::size_t i = 0; i < roles.dut.size(); ++i) {
    StepResult result = result_head(task.step(), roles.dut[i]);
    add_value(task.recipe->series, evaluated, acs, evaluated.result.channels[i], result);
    const std::size_t column = *input.sensor.channel(roles.dut[i].channel);
    result.unit =
        ratio_unit(excitation_unit(acs), input.sensor.description().channels[column].unit);
    add_input(task, of_step, result);
    for (Flag& flag : flags_of_agreement(evaluated.result.channels[i])) {
      result.flags.push_back(std::move(flag));
    }
    for (const SignalCheck& check : {reference, sync, traces}) {
      add_check(check, result);
    }
    std::vector<analysis::SineShape> shapes;
    add_check(check_series(checked, roles.dut[i], column, shapes), result);
    check_shape_of_shots(evaluated.result.reference, is_differentiated(acs), roles.dut[i].text(),
                         shapes, result);
    std::vector<ChannelLines> lines = common_lines;
    lines.push_back(lines_of_series(checked, roles.dut[i], column));
    add_lines(std::move(lines), result);
    results.push_back(std::move(result));
  }
  return results;
}

} // namespace

SeriesStepOutput evaluate_series_step(const SeriesStepInput& step) {
  const RoleNames& roles = step.task.recipe->roles;
  if (step.shots.empty()) {
    return without_result(step, fmt::format("no shot of {} and {} was triggered in this step",
                                            step.oscilloscope.source(), step.sensor.source()));
  }
  const SelectedChannels acs(step.acs, {roles.reference, roles.sync_acs},
                             step.task.recipe->mains_hz);
  const std::vector<std::size_t> columns = columns_of(step.sensor, roles.dut);
  const std::size_t sync = *step.oscilloscope.channel(roles.sync_sensor.channel);
  std::vector<Flag> flags = step.task.flags;
  const auto shots =
      shots_of_usual_length(step.shots, *std::ranges::max_element(columns) + 1, sync + 1, flags);
  if (shots.empty()) {
    return without_result(step, "the records of the shots lack a channel that was described");
  }
  const auto reference = reference_response(*step.task.recipe, step.task.step());
  if (!reference) {
    return without_result(step, reference.error().message);
  }
  const auto samples = reference_channel(acs);
  if (!samples) {
    return without_result(step, samples.error().message);
  }
  analysis::SeriesStampingInput input = input_of(step.task, acs, *samples, shots, sync, columns);
  input.reference_response = *reference;
  const auto evaluated = evaluate_series(input, step.start_so_far);
  if (!evaluated) {
    return without_result(step, evaluated.error().message);
  }
  add_flags(step, *evaluated, shots.size(), flags);
  return {results_of(step, acs, shots, *evaluated, flags), evaluated->result.rate,
          evaluated->start.kind, evaluated->start_evidence, bends_of(evaluated->result)};
}

void add_shared_start(const analysis::SharedStartScatter& start, StepResult& result) {
  constexpr double microseconds = 1e6;
  const bool undecided = has_flag(result.flags, ResultFlag::start_undecided);
  const auto row = std::ranges::find_if(result.budget, [](const auto& one) {
    return one.kind == analysis::ContributionKind::series_start;
  });
  if (undecided || row == result.budget.end()) {
    return; // by itself: its row is there; or no value
  }
  row->u_phase_rad = 2.0 * std::numbers::pi * result.frequency_hz * start.u_latency_s;
  result.u_phase_rad = u_phase_of(result.budget);
  if (start.is_shown) {
    result.flags.push_back(flag_with_reason(
        ResultFlag::start_undecided,
        fmt::format("all steps together show that it scatters by {:.2g} us, which this one hides "
                    "in its noise",
                    microseconds * start.scatter_s)));
  }
}

} // namespace dyncal::inline evaluation
