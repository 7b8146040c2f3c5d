#include "services/evaluation/recipe/recipe.hpp"

#include <algorithm>

#include <fmt/core.h>

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

// A reference without samples.
Expected<void> check_reference_table(const Recipe& recipe) {
  if (recipe.reference_table.empty()) {
    return {};
  }
  if (recipe.method() != EvaluationMethod::sample_timestamping ||
      has_own_clocks(recipe.dut(), recipe.roles.sync_sensor)) {
    return refuse("a reference that is a table (reference_table) needs method kind = "
                  "\"sample-timestamping\", and a sensor that the DAU of sync_dau stamps");
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
