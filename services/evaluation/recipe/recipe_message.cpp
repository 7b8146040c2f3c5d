#include "services/evaluation/recipe/recipe_message.hpp"

#include <fmt/core.h>

#include "services/contract/evaluation_method_message.hpp"

namespace dyncal::inline evaluation {
namespace {

tl::unexpected<Error> refuse(std::string sentence) {
  return fail(ErrorCode::bad_argument, std::move(sentence));
}

std::string text_of(const ChannelName& name) {
  return name.source.empty() ? std::string() : name.text();
}

void write_own_part(const AnalogueRoles&, wire::Measurement&) {}
void write_own_part(const AbsoluteTimeRoles&, wire::Measurement&) {}

void write_own_part(const SampleStampingRoles& roles, wire::Measurement& measurement) {
  for (const analysis::AdcCalibrationPoint& point : roles.adc_calibration) {
    wire::AdcCalibrationPoint message;
    message.frequency_hz(point.frequency_hz);
    message.test_amplitude_vpp(point.test_amplitude_vpp);
    message.gain(point.gain);
    message.phase_lag_rad(point.phase_lag_rad);
    message.u_gain(point.u_gain);
    message.u_phase_lag_rad(point.u_phase_lag_rad);
    measurement.adc_calibration().push_back(message);
  }
  measurement.u_adc_delay_s(roles.u_adc_delay_s);
}

void write_own_part(const SeriesRoles& roles, wire::Measurement& measurement) {
  measurement.shots(roles.shots);
  measurement.trigger_phase_correction(roles.trigger_phase_correction);
  measurement.dso_delay_s(roles.dso_delay_s);
  measurement.u_dso_delay_s(roles.u_dso_delay_s);
  measurement.u_acs_rate_rel(roles.u_acs_rate_rel);
  measurement.u_dso_rate_rel(roles.u_dso_rate_rel);
}

void write_reference(const Recipe& recipe, wire::Measurement& measurement) {
  for (const analysis::ReferenceCalibrationPoint& point : recipe.reference_calibration) {
    wire::ReferenceCalibrationPoint message;
    message.frequency_hz(point.frequency_hz);
    message.level_m_s2(point.level_m_s2);
    message.magnitude(point.magnitude);
    message.phase_rad(point.phase_rad);
    for (const analysis::ReferenceContribution& one : point.contributions) {
      wire::ReferenceContribution contribution;
      contribution.name(one.name);
      contribution.u_magnitude_rel(one.u_magnitude_rel);
      contribution.u_phase_rad(one.u_phase_rad);
      contribution.degrees_of_freedom(one.degrees_of_freedom);
      message.contributions().push_back(contribution);
    }
    measurement.reference_calibration().push_back(message);
  }
}

void write_steps(const Recipe& recipe, wire::Measurement& measurement) {
  for (const RecipeStep& step : recipe.steps) {
    wire::PlannedStep message;
    message.step(step.step);
    message.repetition(step.repetition);
    message.frequency_text_hz(step.frequency_text_hz);
    message.level_m_s2(step.level_m_s2);
    message.settling_s(step.settling_s);
    message.duration_s(step.duration_s);
    measurement.steps().push_back(message);
  }
}

Expected<void> read_role(const char* role, const std::string& text, ChannelName& name) {
  auto parsed = parse_channel_name(text);
  if (!parsed) {
    return refuse(
        fmt::format("the recipe's {} is \"{}\" but must be \"source/channel\"", role, text));
  }
  name = std::move(*parsed);
  return {};
}

Expected<RoleNames> read_roles(const wire::Measurement& measurement) {
  RoleNames roles;
  const auto method = from_wire(measurement.method());
  if (!method) {
    return refuse(fmt::format("the recipe's method has number {}, which this version does not "
                              "know; update dyncal-analysis",
                              static_cast<std::uint32_t>(measurement.method())));
  }
  roles.method = *method;
  const bool without_sync = is_without_sync(roles.method);
  auto read = read_role("reference", measurement.reference(), roles.reference);
  if (read && !(without_sync && measurement.sync_acs().empty())) {
    read = read_role("sync_acs", measurement.sync_acs(), roles.sync_acs);
  }
  if (read && !without_sync) {
    const bool by_series = roles.method == EvaluationMethod::series_timestamping;
    read = by_series ? read_role("sync_dso", measurement.sync_dso(), roles.sync_sensor)
                     : read_role("sync_dau", measurement.sync_dau(), roles.sync_sensor);
  }
  for (const std::string& text : measurement.dut()) {
    read = read ? read_role("dut", text, roles.dut.emplace_back()) : read;
  }
  DYNCAL_TRY(read);
  return roles;
}

MethodDetails read_details(const wire::Measurement& measurement) {
  MethodDetails details{.adc_calibration = {},
                        .shots = measurement.shots(),
                        .trigger_phase_correction = measurement.trigger_phase_correction(),
                        .dso_delay_s = measurement.dso_delay_s(),
                        .u_dso_delay_s = measurement.u_dso_delay_s(),
                        .u_acs_rate_rel = measurement.u_acs_rate_rel(),
                        .u_dso_rate_rel = measurement.u_dso_rate_rel(),
                        .u_adc_delay_s = measurement.u_adc_delay_s()};
  for (const wire::AdcCalibrationPoint& point : measurement.adc_calibration()) {
    details.adc_calibration.push_back({point.frequency_hz(), point.test_amplitude_vpp(),
                                       point.gain(), point.phase_lag_rad(), point.u_gain(),
                                       point.u_phase_lag_rad()});
  }
  return details;
}

Expected<void> read_steps(const wire::Measurement& measurement, Recipe& recipe) {
  for (const wire::PlannedStep& planned : measurement.steps()) {
    const auto frequency = analysis::Frequency::parse(planned.frequency_text_hz());
    if (!frequency) {
      return refuse(fmt::format(
          "step {} of the recipe has frequency \"{}\", settling {} s, duration {} s",
          planned.step(), planned.frequency_text_hz(), planned.settling_s(), planned.duration_s()));
    }
    recipe.steps.push_back({planned.step(), planned.repetition(), planned.frequency_text_hz(),
                            *frequency, planned.level_m_s2(), planned.settling_s(),
                            planned.duration_s()});
  }
  return {};
}

void read_reference(const wire::Measurement& measurement, Recipe& recipe) {
  for (const wire::ReferenceCalibrationPoint& message : measurement.reference_calibration()) {
    analysis::ReferenceCalibrationPoint point{
        message.frequency_hz(), message.level_m_s2(), message.magnitude(), message.phase_rad(), {}};
    for (const wire::ReferenceContribution& one : message.contributions()) {
      point.contributions.push_back({.name = one.name(),
                                     .u_magnitude_rel = one.u_magnitude_rel(),
                                     .u_phase_rad = one.u_phase_rad(),
                                     .degrees_of_freedom = one.degrees_of_freedom()});
    }
    recipe.reference_calibration.push_back(std::move(point));
  }
}

void read_common_part(const wire::Measurement& measurement, Recipe& recipe) {
  recipe.bench = measurement.bench().to_string();
  recipe.run = measurement.run().to_string();
  recipe.whole_record = measurement.whole_record();
  recipe.settling_from_data = measurement.settling_from_data();
  recipe.monte_carlo_trials = measurement.monte_carlo_trials();
  if (measurement.frequency_exact()) {
    recipe.frequency_search_rel = 0.0;
  } else if (measurement.frequency_search_rel() > 0.0) {
    recipe.frequency_search_rel = measurement.frequency_search_rel();
  }
  if (measurement.level_deviation_rel() > 0.0) {
    recipe.level_deviation_rel = measurement.level_deviation_rel();
  }
  if (!measurement.mains_hz().empty()) {
    recipe.mains_hz.assign(measurement.mains_hz().begin(), measurement.mains_hz().end());
  }
  recipe.reference_delay_s = measurement.reference_delay_s();
  recipe.systematic.reference_magnitude_rel = measurement.u_reference_magnitude_rel();
  recipe.systematic.reference_phase_rad = measurement.u_reference_phase_rad();
  recipe.systematic.acs_delay_s = measurement.u_acs_delay_s();
  recipe.text = measurement.recipe();
  recipe.sha256 = measurement.recipe_sha256();
  for (const wire::PlannedSource& source : measurement.sources()) {
    recipe.source_settings.emplace(source.source(), source.settings());
  }
}

} // namespace

wire::Measurement to_message(const Recipe& recipe) {
  const RoleNames roles = role_names(recipe);
  wire::Measurement measurement;
  measurement.bench(recipe.bench);
  measurement.run(recipe.run);
  measurement.method(to_wire(roles.method));
  measurement.reference(roles.reference.text());
  measurement.sync_acs(text_of(roles.sync_acs));
  const bool by_series = roles.method == EvaluationMethod::series_timestamping;
  measurement.sync_dau(by_series ? "" : text_of(roles.sync_sensor));
  measurement.sync_dso(by_series ? text_of(roles.sync_sensor) : "");
  for (const ChannelName& name : roles.dut) {
    measurement.dut().push_back(name.text());
  }
  if (recipe.temperature) {
    measurement.temperature(recipe.temperature->text());
  }
  write_steps(recipe, measurement);
  write_reference(recipe, measurement);
  std::visit([&](const auto& own) { write_own_part(own, measurement); }, recipe.roles);
  measurement.u_reference_magnitude_rel(recipe.systematic.reference_magnitude_rel);
  measurement.u_reference_phase_rad(recipe.systematic.reference_phase_rad);
  measurement.u_acs_delay_s(recipe.systematic.acs_delay_s);
  measurement.frequency_search_rel(recipe.frequency_search_rel);
  measurement.frequency_exact(recipe.frequency_search_rel == 0.0);
  measurement.level_deviation_rel(recipe.level_deviation_rel);
  if (recipe.mains_hz != Recipe{}.mains_hz) {
    measurement.mains_hz().assign(recipe.mains_hz.begin(), recipe.mains_hz.end());
  }
  measurement.reference_delay_s(recipe.reference_delay_s);
  measurement.whole_record(recipe.whole_record);
  measurement.settling_from_data(recipe.settling_from_data);
  measurement.monte_carlo_trials(recipe.monte_carlo_trials);
  measurement.recipe(recipe.text);
  measurement.recipe_sha256(recipe.sha256);
  for (const auto& [name, settings] : recipe.source_settings) {
    wire::PlannedSource source;
    source.source(name);
    source.settings(settings);
    measurement.sources().push_back(source);
  }
  return measurement;
}

Expected<Recipe> parse_recipe(const wire::Measurement& measurement) {
  DYNCAL_TRY(auto roles, read_roles(measurement));
  Recipe recipe;
  recipe.roles = make_roles(std::move(roles), read_details(measurement));
  if (!measurement.temperature().empty()) {
    DYNCAL_TRY(read_role("temperature", measurement.temperature(), recipe.temperature.emplace()));
  }
  read_common_part(measurement, recipe);
  read_reference(measurement, recipe);
  DYNCAL_TRY(read_steps(measurement, recipe).and_then([&] { return check_recipe(recipe); }));
  return recipe;
}

} // namespace dyncal::inline evaluation
