#include "services/evaluation/method/analogue_step_evaluation.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/method/analogue_comparison.hpp"
#include "services/evaluation/method/sample_stamping_step_evaluation.hpp"
#include "services/evaluation/method/settled_part.hpp"
#include "services/evaluation/monte_carlo_check.hpp"

namespace dyncal::services {
namespace {

// The reference, then the channels under calibration.
std::vector<std::size_t> columns_of(const Recipe& recipe, const SourceRecord& acs) {
  std::vector<std::size_t> columns{*acs.channel(recipe.reference.channel)};
  for (const ChannelName& name : recipe.dut) {
    columns.push_back(*acs.channel(name.channel));
  }
  return columns;
}

StretchOfTime after_settling(const Recipe& recipe, const RecipeStep& step,
                             const StepSamples& samples, StretchOfTime stretch,
                             std::vector<std::string>& flags) {
  SettlingColumns sensors{samples, 0, {}};
  for (std::size_t column = 1; column < samples.columns.size(); ++column) {
    sensors.settling.push_back(column);
  }
  const Settled settled =
      settled_part(step, recipe.frequency_search_rel, {samples, 0, {0}}, sensors);
  flags.insert(flags.end(), settled.flags.begin(), settled.flags.end());
  return without_settling(stretch, settled.settling_s, step.duration_s);
}

} // namespace

std::vector<wire::CalibrationResult>
evaluate_analogue_step(const Recipe& recipe, const RecipeStep& step, const SourceRecord& acs,
                       StretchOfTime stretch, std::vector<std::string> flags) {
  const std::vector<std::size_t> columns = columns_of(recipe, acs);
  StepSamples samples = cut(acs, stretch, columns);
  if (recipe.settling_from_data) {
    stretch = after_settling(recipe, step, samples, stretch, flags);
    samples = cut(acs, stretch, columns);
  }
  const auto channel = [&](const ChannelName& name, std::size_t column) {
    return analysis::ChannelSamples{name.text(), samples.columns[column],
                                    acs.description().channels()[columns[column]].resolution()};
  };
  analysis::AnalogueInput input{.frequency = step.frequency};
  input.frequency_search_rel = recipe.frequency_search_rel;
  input.stamps_ns = samples.stamps_ns;
  input.reference = channel(recipe.reference, 0);
  for (std::size_t i = 0; i < recipe.dut.size(); ++i) {
    input.dut.push_back(channel(recipe.dut[i], i + 1));
  }
  input.channel_delay_s = -recipe.reference_delay_s;
  input.systematic.reference_magnitude_rel = recipe.systematic.reference_magnitude_rel;
  input.systematic.reference_phase_rad = recipe.systematic.reference_phase_rad;
  input.systematic.channel_delay_s = recipe.systematic.acs_delay_s;
  const auto evaluated = analysis::evaluate_analogue(input);
  if (!evaluated) {
    return results_of_missing_step(recipe, step, acs, evaluated.error().message);
  }
  const std::string data_sha256 = digest_of({&samples});
  std::vector<wire::CalibrationResult> results;
  for (std::size_t i = 0; i < recipe.dut.size(); ++i) {
    wire::CalibrationResult result =
        point_result(recipe, step, recipe.dut[i], evaluated->points[i], {&evaluated->reference, 1});
    result.unit(ratio_unit(acs, recipe.reference.channel, acs, recipe.dut[i].channel));
    result.samples().push_back(samples_message(acs, samples, stretch));
    result.lost(result.samples()[0].lost());
    result.flags() = flags;
    result.data_sha256(data_sha256);
    add_monte_carlo_check(recipe, evaluated->points[i], {&evaluated->reference, 1}, result);
    results.push_back(std::move(result));
  }
  return results;
}

} // namespace dyncal::services
