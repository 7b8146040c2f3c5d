#include "services/evaluation/method/step_results.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "services/contract/unit.hpp"
#include "services/evaluation/method/clock_check.hpp"
#include "services/evaluation/method/line_check.hpp"
#include "services/evaluation/method/monte_carlo_check.hpp"
#include "services/evaluation/method/reference_channel.hpp"
#include "services/evaluation/method/shape_check.hpp"
#include "services/evaluation/method/unstated_uncertainty.hpp"

namespace dyncal::inline evaluation {
namespace {

// Against the plan, by no more than the recipe's level_deviation_rel. A reference in another unit
// than m/s^2 cannot be compared with it, and a recipe without a level has none to compare with.
std::optional<Flag> find_level_deviation(const RecipeStep& step, double level_deviation_rel,
                                         const analysis::ChannelFit& reference,
                                         const std::string& reference_unit) {
  if (!is_acceleration(reference_unit) || !(step.level_m_s2 > 0.0)) {
    return std::nullopt;
  }
  const double measured_m_s2 = reference.fit.amplitude();
  if (std::abs(measured_m_s2 / step.level_m_s2 - 1.0) <= level_deviation_rel) {
    return std::nullopt;
  }
  return flag_with_reason(
      ResultFlag::level_off_plan,
      fmt::format("{:.4g} m/s^2 in place of {:.4g} m/s^2", measured_m_s2, step.level_m_s2));
}

// The sines of the common channels as results show them: that of the reference in the unit that the
// response is per.
std::vector<analysis::ChannelFit> shown_fits(const StepInput& input,
                                             std::vector<analysis::ChannelFit> common_fits) {
  if (const SelectedChannels* reference = input.common.front().selected) {
    common_fits.front() = excitation_fit(*reference, common_fits.front());
  }
  return common_fits;
}

StepResult point_result(const StepTask& task, const ChannelName& channel,
                        const analysis::TransferPoint& point,
                        const std::vector<analysis::ChannelFit>& common_fits) {
  StepResult result = result_head(task.step(), channel);
  result.valid = true;
  result.magnitude = point.magnitude;
  result.u_magnitude = point.u_magnitude;
  result.phase_rad = point.phase_rad;
  result.u_phase_rad = point.u_phase_rad;
  result.fits = common_fits;
  result.fits.push_back(point.dut);
  result.budget = point.budget;
  return result;
}

// What the evaluation found along the step.
void add_findings(const analysis::PointFindings& point, StepResult& result) {
  result.change = point.change;
  if (point.change) {
    result.flags.push_back(
        flag_of_channel(ResultFlag::changed_within_step, result.channel,
                        fmt::format("by {:.2g} % and {:.2g} rad after {:.2g} s",
                                    100.0 * point.change->magnitude_rel, point.change->phase_rad,
                                    point.change->at_s)));
  }
  if (point.too_short_for_noise) {
    result.flags.push_back(flag_of_source(ResultFlag::too_short_for_noise, result.channel));
  }
}

// Of the channels that all results share. Sync carries phase only, which end stops on both sides
// leave alone: its refusal is none of the results'.
std::vector<SignalCheck> check_common(const std::vector<analysis::ChannelFit>& fits) {
  std::vector<SignalCheck> checks;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    checks.push_back(check_signal(fits[i]));
    if (i > 0) {
      checks.back().refusal.clear();
    }
  }
  return checks;
}

ChannelLines lines_of(const StepTask& task, const StepInput& input, const LineSubject& subject,
                      const analysis::ChannelFit& fit, const SelectedChannel& channel,
                      std::size_t place) {
  return input.rests.empty()
             ? check_lines(*task.recipe, subject, fit, *channel.selected, channel.index)
             : check_lines_beside(*task.recipe, subject, fit, *channel.selected, channel.index,
                                  input.rests[place]);
}

// Lines beside the excitation in the channels that all results share.
std::vector<ChannelLines> lines_of_common(const StepTask& task, const StepInput& input,
                                          const std::vector<analysis::ChannelFit>& fits) {
  const LineSubject subjects[] = {
      {"the reference"}, {"the ACS sync", false}, {"the DAU sync", false}};
  std::vector<ChannelLines> lines;
  for (std::size_t i = 0; i < input.common.size(); ++i) {
    if (input.common[i].selected == nullptr) {
      continue;
    }
    lines.push_back(
        lines_of(task, input, subjects[std::min<std::size_t>(i, 2)], fits[i], input.common[i], i));
  }
  return lines;
}

// Of every source once.
std::vector<SteppedClock> stepped_clocks(const StepTask& task, const StepInput& input) {
  std::vector<const SelectedChannels*> sources;
  for (const SelectedChannel& channel : input.common) {
    if (channel.selected != nullptr) {
      sources.push_back(channel.selected);
    }
  }
  sources.push_back(input.first_dut.selected);
  std::vector<SteppedClock> stepped;
  for (auto source = sources.begin(); source != sources.end(); ++source) {
    if (std::find(sources.begin(), source, *source) == source) {
      const bool linked_by_sync = std::count(source, sources.end(), *source) > 1;
      const auto of_source = find_stepped_clock(**source, task.step().frequency, linked_by_sync);
      stepped.insert(stepped.end(), of_source.begin(), of_source.end());
    }
  }
  return stepped;
}

} // namespace

StepResult result_head(const RecipeStep& step, const ChannelName& channel) {
  StepResult result;
  result.channel = channel.text();
  result.step = step.step;
  result.repetition = step.repetition;
  result.frequency_text_hz = step.frequency_text_hz;
  result.frequency_hz = step.frequency.hz();
  result.level_m_s2 = step.level_m_s2;
  result.excited_axis = step.excited_axis;
  return result;
}

std::vector<StepResult> results_without_value(const RecipeStep& step,
                                              const std::vector<ChannelName>& dut,
                                              const std::string& problem) {
  std::vector<StepResult> results;
  for (const ChannelName& channel : dut) {
    results.push_back(result_head(step, channel));
    results.back().problem = problem;
  }
  return results;
}

void add_check(const SignalCheck& check, StepResult& result) {
  result.signals.push_back(check.signal);
  result.flags.insert(result.flags.end(), check.flags.begin(), check.flags.end());
  if (!check.refusal.empty()) {
    add_refusal(check.refusal, result);
  }
}

void add_refusal(const std::string& sentence, StepResult& result) {
  if (!result.valid) {
    return;
  }
  result.valid = false;
  result.problem = sentence;
  result.magnitude = result.u_magnitude = StepResult::nan_value;
  result.phase_rad = result.u_phase_rad = StepResult::nan_value;
  result.budget.clear();
}

void add_input(const StepTask& task, const StepInput& input, StepResult& result) {
  result.samples = input.samples;
  result.flags = task.flags;
  result.data_sha256 = input.data_sha256;
  if (auto flag = find_level_deviation(task.step(), task.recipe->level_deviation_rel,
                                       result.fits.front(), input.reference_unit)) {
    result.flags.push_back(std::move(*flag));
  }
  for (Flag& flag : flags_of_unstated(*task.recipe)) {
    result.flags.push_back(std::move(flag));
  }
  for (const SourceSamples& samples : input.samples) {
    result.lost += samples.all_lost();
    if (samples.not_trusted > 0) {
      result.flags.push_back(flag_of_source(ResultFlag::stamps_not_trusted, samples.source));
    }
    if (samples.not_measured > 0) {
      result.flags.push_back(flag_of_source(ResultFlag::values_not_measured, samples.source));
    }
  }
}

std::vector<StepResult> make_results(const StepTask& task, const StepInput& input,
                                     const analysis::Expected<EvaluatedStep>& step) {
  if (!step) {
    return results_without_value(task.step(), input.dut, step.error().message);
  }
  if (task.given_up.stop_requested()) {
    return {};
  }
  const std::vector<SignalCheck> common = check_common(step->common_fits);
  const std::vector<ChannelLines> common_lines = lines_of_common(task, input, step->common_fits);
  const std::vector<SteppedClock> stepped = stepped_clocks(task, input);
  const std::vector<analysis::ChannelFit> shown = shown_fits(input, step->common_fits);
  const SelectedChannels* reference = input.common.front().selected; // none of an evaluated one
  const bool differentiated = reference != nullptr && is_differentiated(*reference);
  std::vector<StepResult> results;
  for (std::size_t i = 0; i < input.dut.size() && !task.given_up.stop_requested(); ++i) {
    StepResult& result =
        results.emplace_back(point_result(task, input.dut[i], step->points[i], shown));
    result.unit = input.units[i];
    add_input(task, input, result);
    add_clock_check(stepped, result);
    result.clock_link = step->findings.clock_link;
    if (i < step->findings.points.size()) {
      add_findings(step->findings.points[i], result);
    }
    for (const SignalCheck& check : common) {
      add_check(check, result);
    }
    add_check(check_signal(step->points[i].dut), result);
    check_shape(step->common_fits.front(), differentiated, step->points[i].dut, result);
    std::vector<ChannelLines> lines = common_lines;
    lines.push_back(lines_of(task, input, {"the sensor"}, step->points[i].dut,
                             {input.first_dut.selected, input.first_dut.index + i},
                             input.common.size() + i));
    add_lines(std::move(lines), result);
    if (result.valid) {
      add_monte_carlo_check(task.recipe->monte_carlo_trials, step->points[i], step->common_fits,
                            task.stop, result);
    }
  }
  return results;
}

std::vector<std::string> units_of(const SelectedChannels& acs, const SelectedChannels& dut,
                                  std::size_t first_dut) {
  std::vector<std::string> units;
  for (std::size_t i = first_dut; i < dut.size(); ++i) {
    units.push_back(ratio_unit(excitation_unit(acs), dut.unit(i)));
  }
  return units;
}

} // namespace dyncal::inline evaluation
