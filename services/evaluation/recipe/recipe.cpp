#include "services/evaluation/recipe/recipe.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "analysis/sine/multisine_lines.hpp"

namespace dyncal::inline evaluation {
namespace {

// Of a value; all of them are held while it is drawn, 16 bytes each.
constexpr std::uint64_t max_monte_carlo_trials = 100'000'000;

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    names.push_back(name);
  }
}

tl::unexpected<Error> refuse(std::string sentence) {
  return fail(ErrorCode::bad_argument, std::move(sentence));
}

// The lines of every repetition are those of the first.
bool has_whole_waveforms(const Recipe& recipe) {
  const std::size_t lines = recipe.lines_at_once();
  for (std::size_t i = 0; i < recipe.steps.size(); ++i) {
    const RecipeStep& step = recipe.steps[i];
    const RecipeStep& first = recipe.steps[i / lines * lines];
    if (step.repetition != first.repetition || step.duration_s != first.duration_s ||
        step.settling_s != first.settling_s ||
        step.frequency_text_hz != recipe.steps[i % lines].frequency_text_hz) {
      return false;
    }
  }
  return recipe.steps.size() % lines == 0;
}

Expected<void> check_multisine(const Recipe& recipe, bool own_clocks) {
  if (recipe.method() != EvaluationMethod::sample_timestamping || own_clocks) {
    return refuse("a multi-sine is evaluated with sample time stamping by a DAU that records sync, "
                  "and with no other method; excite one frequency after the other "
                  "(excitation.kind = \"sine\")");
  }
  if (recipe.settling_from_data || recipe.whole_record || recipe.monte_carlo_trials > 0 ||
      !(recipe.frequency_search_rel > 0.0)) {
    return refuse("a multi-sine has neither settling = \"from-data\" nor window = "
                  "\"whole-record\" nor monte_carlo_trials, and its clocks are always searched "
                  "for; leave them out of the bench file");
  }
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < recipe.lines_at_once(); ++i) {
    lines.push_back(recipe.steps[i].frequency_text_hz);
  }
  const auto checked =
      analysis::check_multisine_lines(lines, recipe.multisine_period_s, recipe.mains_hz);
  if (!checked) {
    return refuse("the lines of the multi-sine: " + checked.error().message);
  }
  if (!has_whole_waveforms(recipe)) {
    return refuse("the repetitions of a multi-sine have the same lines in the same order, each of "
                  "one duration");
  }
  return {};
}

// A reference without samples.
Expected<void> check_reference_table(const Recipe& recipe) {
  if (recipe.reference_table.empty()) {
    return {};
  }
  if (recipe.is_multisine() || recipe.method() != EvaluationMethod::sample_timestamping ||
      has_own_clocks(recipe.dut(), recipe.roles.sync_sensor)) {
    return refuse(
        "a reference that is a table (reference_table) needs method kind = "
        "\"sample-timestamping\", one frequency after the other, and a sensor that the DAU "
        "of sync_dau stamps");
  }
  if (recipe.reference().source != recipe.reference_table ||
      recipe.excitation().source != recipe.reference_table) {
    return refuse(fmt::format("the recipe's reference_table is source '{}', but its reference is "
                              "{}, and its sync_acs {}; they must be of that source",
                              recipe.reference_table, recipe.reference().text(),
                              recipe.excitation().text()));
  }
  if (recipe.settling_from_data || recipe.whole_record) {
    return refuse("a reference that is a table (reference_table) has no samples to see the "
                  "settling of, and belongs to steps: leave settling = \"from-data\" and "
                  "whole_record out of the bench file");
  }
  return {};
}

Expected<void> check_responses(const Recipe& recipe) {
  for (const RecipeStep& step : recipe.steps) {
    if (const auto reference = reference_response(recipe, step); !reference) {
      return refuse(fmt::format("step {} of the recipe: {}", step.step, reference.error().message));
    }
    for (const ChannelResponse& one : recipe.channel_responses) {
      const auto response =
          analysis::reference_response_at(one.points, step.frequency.hz(), step.level_m_s2);
      if (!response) {
        return refuse(
            fmt::format("step {} of the recipe: the sensitivity of {} is not stated there: {}",
                        step.step, one.channel.text(), response.error().message));
      }
    }
  }
  return {};
}

} // namespace

std::size_t Recipe::lines_at_once() const {
  if (!is_multisine()) {
    return 1;
  }
  const auto other = std::ranges::find_if(
      steps, [&](const RecipeStep& step) { return step.repetition != steps.front().repetition; });
  return std::max<std::size_t>(1, static_cast<std::size_t>(other - steps.begin()));
}

std::vector<ChannelName> Recipe::channels() const {
  std::vector<ChannelName> all;
  if (reference_table.empty()) {
    all = {reference(), excitation()};
  }
  if (!roles.sync_sensor.source.empty()) {
    all.push_back(roles.sync_sensor);
  }
  all.insert(all.end(), dut().begin(), dut().end());
  if (roles.temperature) {
    all.push_back(*roles.temperature);
  }
  return all;
}

std::vector<std::string> Recipe::dut_sources() const {
  std::vector<std::string> names;
  for (const ChannelName& channel : dut()) {
    add_once(names, channel.source);
  }
  return names;
}

std::vector<std::string> Recipe::sources() const {
  std::vector<std::string> names;
  for (const ChannelName& channel : channels()) {
    add_once(names, channel.source);
  }
  return names;
}

Expected<void> check_recipe(const Recipe& recipe) {
  if (const auto problem = find_role_problem(recipe.roles)) {
    return refuse(fmt::format("the recipe's {} {}", problem->role, problem->sentence));
  }
  if (recipe.steps.empty()) {
    return refuse("the recipe has no excitation steps");
  }
  for (const RecipeStep& step : recipe.steps) {
    if (!(step.duration_s > 0.0) || !(step.settling_s >= 0.0)) {
      return refuse(
          fmt::format("step {} of the recipe has frequency \"{}\", settling {} s, duration {} s",
                      step.step, step.frequency_text_hz, step.settling_s, step.duration_s));
    }
  }
  DYNCAL_TRY(check_reference_table(recipe));
  DYNCAL_TRY(check_responses(recipe));
  if (recipe.whole_record && recipe.steps.size() != 1) {
    return refuse(
        fmt::format("the recipe evaluates whole records but has {} steps; only one is possible",
                    recipe.steps.size()));
  }
  const bool own_clocks = recipe.method() == EvaluationMethod::absolute_time ||
                          (recipe.method() == EvaluationMethod::sample_timestamping &&
                           has_own_clocks(recipe.dut(), recipe.roles.sync_sensor));
  if (recipe.is_multisine()) {
    DYNCAL_TRY(check_multisine(recipe, own_clocks));
  }
  if (recipe.method() == EvaluationMethod::series_timestamping &&
      (recipe.settling_from_data || recipe.monte_carlo_trials > 0)) {
    return refuse("series time stamping has neither settling = \"from-data\" nor "
                  "monte_carlo_trials; leave them out of the bench file");
  }
  if (recipe.monte_carlo_trials > max_monte_carlo_trials) {
    return refuse(
        fmt::format("the recipe asks for {} Monte Carlo trials of a value, and at most {} "
                    "can be drawn: lower uncertainty.monte_carlo_trials",
                    recipe.monte_carlo_trials, max_monte_carlo_trials));
  }
  if (own_clocks && recipe.settling_from_data) {
    return refuse("sensors with stamps of their own are evaluated without settling = "
                  "\"from-data\"; leave it out of the bench file and give the longest settling as "
                  "settling_s");
  }
  return {};
}

analysis::Expected<analysis::ReferenceResponse> reference_response(const Recipe& recipe,
                                                                   const RecipeStep& step) {
  if (recipe.reference_calibration.empty()) {
    return analysis::ReferenceResponse{};
  }
  return analysis::reference_response_at(recipe.reference_calibration, step.frequency.hz(),
                                         step.level_m_s2);
}

analysis::Expected<analysis::AdcResponse> adc_response(const Recipe& recipe,
                                                       const RecipeStep& step) {
  if (recipe.adc_calibration.empty()) {
    return analysis::AdcResponse{.u_phase_lag_rad =
                                     step.frequency.angular() * recipe.u_adc_delay_s};
  }
  return analysis::adc_response_at(recipe.adc_calibration, step.frequency.hz());
}

} // namespace dyncal::inline evaluation
