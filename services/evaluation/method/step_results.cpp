#include "services/evaluation/method/step_results.hpp"

#include "services/evaluation/method/level_check.hpp"
#include "services/evaluation/method/monte_carlo_check.hpp"

namespace dyncal::services {
namespace {

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

} // namespace

StepResult result_head(const RecipeStep& step, const ChannelName& channel) {
  StepResult result;
  result.channel = channel.text();
  result.step = step.step;
  result.repetition = step.repetition;
  result.frequency_text_hz = step.frequency_text_hz;
  result.frequency_hz = step.frequency.hz();
  result.level_m_s2 = step.level_m_s2;
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

void add_input(const StepTask& task, const StepInput& input, StepResult& result) {
  result.samples = input.samples;
  result.flags = task.flags;
  result.data_sha256 = input.data_sha256;
  if (auto flag = find_level_deviation(task.step(), task.recipe->level_deviation_rel,
                                       result.fits.front(), input.reference_unit)) {
    result.flags.push_back(std::move(*flag));
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
  std::vector<StepResult> results;
  for (std::size_t i = 0; i < input.dut.size(); ++i) {
    results.push_back(point_result(task, input.dut[i], step->points[i], step->common_fits));
    results.back().unit = input.units[i];
    add_input(task, input, results.back());
    add_monte_carlo_check(task.recipe->monte_carlo_trials, step->points[i], step->common_fits,
                          results.back());
  }
  return results;
}

std::vector<std::string> units_of(const SelectedChannels& acs, const SelectedChannels& dut,
                                  std::size_t first_dut) {
  std::vector<std::string> units;
  for (std::size_t i = first_dut; i < dut.size(); ++i) {
    units.push_back(ratio_unit(acs.unit(0), dut.unit(i)));
  }
  return units;
}

} // namespace dyncal::services
