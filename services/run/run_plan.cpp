#include "services/run/run_plan.hpp"

#include <fstream>
#include <iterator>

#include <fmt/core.h>

#include "analysis/base/frequency.hpp"
#include "services/contract/digest.hpp"
#include "services/run/level_settling.hpp"

namespace dyncal::inline run {
namespace {

std::vector<RecipeStep> plan_steps(const BenchFile& file) {
  const ExcitationSettings& excitation = file.excitation;
  std::vector<RecipeStep> steps;
  const auto add = [&](int repetition, std::size_t i) {
    const std::string& text = excitation.frequencies_hz[i];
    const auto frequency = *analysis::Frequency::parse(text); // the bench file was checked
    steps.push_back({.step = static_cast<std::uint32_t>(steps.size() + 1),
                     .repetition = static_cast<std::uint32_t>(repetition),
                     .frequency_text_hz = text,
                     .frequency = frequency,
                     .level_m_s2 = excitation.levels_m_s2[i],
                     .excited_axis = excitation.axis,
                     .settling_s = excitation.multisine
                                       ? excitation.settling_s
                                       : planned_settling_s(file, frequency.hz(), repetition),
                     .duration_s = excitation.duration_s});
  };
  for (int repetition = 1; repetition <= excitation.repetitions; ++repetition) {
    for (std::size_t i = 0; i < excitation.frequencies_hz.size(); ++i) {
      add(repetition, i);
    }
  }
  if (excitation.repeat_first) {
    add(excitation.repetitions + 1, 0);
  }
  return steps;
}

} // namespace

Expected<Recipe> plan_recipe(const BenchFile& file, const std::string& run,
                             const std::vector<analysis::AdcCalibrationPoint>& adc_calibration) {
  Recipe recipe;
  recipe.bench = file.bench;
  recipe.run = run;
  recipe.roles = {.method = file.method.kind,
                  .reference = file.method.reference,
                  .sync_acs = file.method.sync_acs,
                  .sync_sensor = file.method.sync_dau,
                  .dut = file.method.dut,
                  .temperature = file.method.temperature};
  recipe.adc_calibration = adc_calibration;
  recipe.u_adc_delay_s = file.uncertainty.adc_delay_s;
  recipe.series = {.shots = static_cast<std::uint32_t>(file.method.shots),
                   .trigger_phase_correction = file.method.trigger_phase_correction,
                   .dso_delay_s = file.corrections.dso_delay_s,
                   .u_dso_delay_s = file.corrections.u_dso_delay_s,
                   .u_acs_rate_rel = file.uncertainty.acs_rate_rel,
                   .u_dso_rate_rel = file.uncertainty.dso_rate_rel};
  recipe.steps = plan_steps(file);
  recipe.settling_from_data = file.excitation.settling_from_data;
  recipe.monte_carlo_trials = file.uncertainty.monte_carlo_trials;
  recipe.whole_record = file.excitation.whole_record;
  if (file.excitation.multisine) {
    recipe.multisine_period_s = file.excitation.multisine->period_s;
  }
  recipe.frequency_search_rel = file.method.frequency_search_rel;
  recipe.clock_tolerance_rel = 1e-6 * file.method.clock_tolerance_ppm;
  recipe.dut_phase = file.method.dut_phase;
  if (!file.method.mains_hz.empty()) {
    recipe.mains_hz = file.method.mains_hz;
  }
  recipe.level_deviation_rel =
      file.excitation.level_deviation_rel.value_or(recipe.level_deviation_rel);
  recipe.reference_delay_s = file.corrections.reference_delay_s;
  recipe.reference_calibration = file.corrections.reference;
  recipe.channel_responses = file.corrections.channel_responses;
  recipe.reference_standard = file.corrections.reference_standard;
  recipe.channel_axes = file.method.axes;
  recipe.transverse_motion = file.excitation.transverse_motion;
  recipe.systematic.reference_magnitude_rel = file.uncertainty.reference_magnitude_rel;
  recipe.systematic.reference_phase_rad = file.uncertainty.reference_phase_rad;
  recipe.systematic.acs_delay_s = file.uncertainty.acs_delay_s;
  recipe.text = file.text;
  recipe.sha256 = file.sha256;
  for (const SourceSettings& source : file.sources) {
    recipe.source_settings.emplace(source.name, source.origin.settings);
  }
  if (const SourceSettings* source = file.source(file.method.reference.source);
      source != nullptr && source->is<TableSourceSettings>()) {
    recipe.reference_table = source->name;
  }
  DYNCAL_TRY(check_recipe(recipe));
  return recipe;
}

Expected<void> check_for_run(const Recipe& recipe) {
  // Not in the contract's message.
  if (!recipe.channel_responses.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("the sensitivity of {} is taken from results by 'dyncal analyse' "
                            "alone: for a run leave it out of the bench file",
                            recipe.channel_responses.front().channel.text()));
  }
  return {};
}

std::optional<AdcFile> adc_file_of(const BenchFile& bench) {
  if (!bench.corrections.adc) {
    return std::nullopt;
  }
  std::ifstream file(bench.corrections.adc->file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return AdcFile{bench.corrections.adc->file.string(), bench.corrections.adc->channel,
                 sha256_hex(text)};
}

} // namespace dyncal::inline run
