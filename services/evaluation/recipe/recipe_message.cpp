#include "services/evaluation/recipe/recipe_message.hpp"

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"
#include "services/contract/evaluation_method_message.hpp"
#include "services/contract/message_members.hpp"

namespace dyncal::inline evaluation {

void message_members(auto& visit, Either<analysis::AdcCalibrationPoint> auto& point,
                     auto& message) {
  visit(point.frequency_hz, message.frequency_hz());
  visit(point.test_amplitude_vpp, message.test_amplitude_vpp());
  visit(point.gain, message.gain());
  visit(point.phase_lag_rad, message.phase_lag_rad());
  visit(point.u_gain, message.u_gain());
  visit(point.u_phase_lag_rad, message.u_phase_lag_rad());
}

void message_members(auto& visit, Either<analysis::ReferenceContribution> auto& one,
                     auto& message) {
  visit(one.name, message.name());
  visit(one.u_magnitude_rel, message.u_magnitude_rel());
  visit(one.u_phase_rad, message.u_phase_rad());
  visit(one.degrees_of_freedom, message.degrees_of_freedom());
}

void message_members(auto& visit, Either<analysis::ReferenceCalibrationPoint> auto& point,
                     auto& message) {
  visit(point.frequency_hz, message.frequency_hz());
  visit(point.level_m_s2, message.level_m_s2());
  visit(point.magnitude, message.magnitude());
  visit(point.phase_rad, message.phase_rad());
  visit(point.contributions, message.contributions());
}

void message_members(auto& visit, Either<CalibratedDevice> auto& one, auto& message) {
  visit(one.name, message.name());
  visit(one.manufacturer, message.manufacturer());
  visit(one.model, message.model());
  visit(one.serial, message.serial());
  visit(one.certificate, message.certificate());
  visit(one.issued_by, message.issued_by());
  visit(one.issued, message.issued());
  visit(one.valid_until, message.valid_until());
}

void message_members(auto& visit, Either<ChannelAxis> auto& one, auto& message) {
  visit(one.channel, message.channel());
  visit(one.axis, message.axis());
}

void message_members(auto& visit, Either<TransverseMotionPoint> auto& one, auto& message) {
  visit(one.frequency_hz, message.frequency_hz());
  visit(one.ratio, message.ratio());
}

void message_members(auto& visit, Either<RecipeStep> auto& step, auto& message) {
  visit(step.step, message.step());
  visit(step.repetition, message.repetition());
  visit(step.frequency_text_hz, message.frequency_text_hz());
  visit(step.level_m_s2, message.level_m_s2());
  visit(step.settling_s, message.settling_s());
  visit(step.duration_s, message.duration_s());
}

// What is the same in both, and needs no check.
void message_members(auto& visit, Either<Recipe> auto& recipe, auto& measurement) {
  visit(recipe.bench, measurement.bench());
  visit(recipe.run, measurement.run());
  visit(recipe.whole_record, measurement.whole_record());
  visit(recipe.settling_from_data, measurement.settling_from_data());
  visit(recipe.monte_carlo_trials, measurement.monte_carlo_trials());
  visit(recipe.reference_delay_s, measurement.reference_delay_s());
  visit(recipe.reference_calibration, measurement.reference_calibration());
  visit(recipe.reference_standard.devices, measurement.reference_devices());
  visit(recipe.reference_standard.standard, measurement.reference_standard());
  visit(recipe.reference_standard.traceability, measurement.reference_traceability());
  visit(recipe.reference_standard.file, measurement.reference_file());
  visit(recipe.reference_standard.file_sha256, measurement.reference_file_sha256());
  visit(recipe.reference_table, measurement.reference_table());
  visit(recipe.multisine_period_s, measurement.multisine_period_s());
  visit(recipe.channel_axes, measurement.channel_axes());
  visit(recipe.transverse_motion.points, measurement.transverse_motion());
  visit(recipe.transverse_motion.source, measurement.transverse_motion_source());
  visit(recipe.systematic.reference_magnitude_rel, measurement.u_reference_magnitude_rel());
  visit(recipe.systematic.reference_phase_rad, measurement.u_reference_phase_rad());
  visit(recipe.systematic.acs_delay_s, measurement.u_acs_delay_s());
  visit(recipe.text, measurement.recipe());
  visit(recipe.sha256, measurement.recipe_sha256());
}

namespace {

// What the recipe's method alone has.
void members_of_method(auto& visit, Either<Recipe> auto& recipe, auto& measurement) {
  if (recipe.method() == EvaluationMethod::sample_timestamping) {
    visit(recipe.adc_calibration, measurement.adc_calibration());
    visit(recipe.u_adc_delay_s, measurement.u_adc_delay_s());
  } else if (recipe.method() == EvaluationMethod::series_timestamping) {
    visit(recipe.series.shots, measurement.shots());
    visit(recipe.series.trigger_phase_correction, measurement.trigger_phase_correction());
    visit(recipe.series.dso_delay_s, measurement.dso_delay_s());
    visit(recipe.series.u_dso_delay_s, measurement.u_dso_delay_s());
    visit(recipe.series.u_acs_rate_rel, measurement.u_acs_rate_rel());
    visit(recipe.series.u_dso_rate_rel, measurement.u_dso_rate_rel());
  }
}

tl::unexpected<Error> refuse(std::string sentence) {
  return fail(ErrorCode::bad_argument, std::move(sentence));
}

std::string text_of(const ChannelName& name) {
  return name.source.empty() ? std::string() : name.text();
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
  if (read && !measurement.temperature().empty()) {
    read = read_role("temperature", measurement.temperature(), roles.temperature.emplace());
  }
  DYNCAL_TRY(read);
  return roles;
}

Expected<void> read_steps(const wire::Measurement& measurement, Recipe& recipe) {
  for (const wire::PlannedStep& planned : measurement.steps()) {
    const auto frequency = analysis::Frequency::parse(planned.frequency_text_hz());
    if (!frequency) {
      return refuse(fmt::format(
          "step {} of the recipe has frequency \"{}\", settling {} s, duration {} s",
          planned.step(), planned.frequency_text_hz(), planned.settling_s(), planned.duration_s()));
    }
    MessageReader reader;
    message_members(
        reader,
        recipe.steps.emplace_back(RecipeStep{.frequency_text_hz = {}, .frequency = *frequency}),
        planned);
    recipe.steps.back().excited_axis = measurement.excited_axis();
  }
  return {};
}

Expected<void> read_dut_phase(const std::string& text, Recipe& recipe) {
  if (text.empty()) {
    return {};
  }
  const auto phase = parse_enumerator<DutPhase>(text);
  if (!phase) {
    return refuse(fmt::format(
        "dut_phase is \"{}\", which this version does not know; install the conductor's", text));
  }
  recipe.dut_phase = *phase;
  return {};
}

void read_common_part(const wire::Measurement& measurement, Recipe& recipe) {
  MessageReader reader;
  message_members(reader, recipe, measurement);
  members_of_method(reader, recipe, measurement);
  if (measurement.frequency_exact()) {
    recipe.frequency_search_rel = 0.0;
  } else if (measurement.frequency_search_rel() > 0.0) {
    recipe.frequency_search_rel = measurement.frequency_search_rel();
  }
  if (measurement.level_deviation_rel() > 0.0) {
    recipe.level_deviation_rel = measurement.level_deviation_rel();
  }
  if (measurement.clock_tolerance_rel() > 0.0) {
    recipe.clock_tolerance_rel = measurement.clock_tolerance_rel();
  }
  if (!measurement.mains_hz().empty()) {
    recipe.mains_hz.assign(measurement.mains_hz().begin(), measurement.mains_hz().end());
  }
  for (const wire::PlannedSource& source : measurement.sources()) {
    recipe.source_settings.emplace(source.source(), source.settings());
  }
}

} // namespace

wire::Measurement to_message(const Recipe& recipe) {
  const RoleNames& roles = recipe.roles;
  wire::Measurement measurement;
  MessageWriter writer;
  message_members(writer, recipe, measurement);
  members_of_method(writer, recipe, measurement);
  writer(recipe.steps, measurement.steps());
  measurement.excited_axis(recipe.steps.empty() ? "" : recipe.steps.front().excited_axis);
  measurement.method(to_wire(roles.method));
  measurement.reference(roles.reference.text());
  measurement.sync_acs(text_of(recipe.excitation()));
  const bool by_series = roles.method == EvaluationMethod::series_timestamping;
  measurement.sync_dau(by_series ? "" : text_of(roles.sync_sensor));
  measurement.sync_dso(by_series ? text_of(roles.sync_sensor) : "");
  for (const ChannelName& name : roles.dut) {
    measurement.dut().push_back(name.text());
  }
  measurement.temperature(text_of(roles.temperature.value_or(ChannelName{})));
  measurement.frequency_search_rel(recipe.frequency_search_rel);
  measurement.frequency_exact(recipe.frequency_search_rel == 0.0);
  measurement.level_deviation_rel(recipe.level_deviation_rel);
  if (recipe.clock_tolerance_rel != Recipe{}.clock_tolerance_rel) {
    measurement.clock_tolerance_rel(recipe.clock_tolerance_rel);
  }
  if (recipe.dut_phase != Recipe{}.dut_phase) {
    measurement.dut_phase(to_string(recipe.dut_phase));
  }
  if (recipe.mains_hz != Recipe{}.mains_hz) {
    measurement.mains_hz().assign(recipe.mains_hz.begin(), recipe.mains_hz.end());
  }
  for (const auto& [name, settings] : recipe.source_settings) {
    wire::PlannedSource source;
    source.source(name);
    source.settings(settings);
    measurement.sources().push_back(source);
  }
  return measurement;
}

Expected<Recipe> parse_recipe(const wire::Measurement& measurement) {
  Recipe recipe;
  DYNCAL_TRY(recipe.roles, read_roles(measurement));
  read_common_part(measurement, recipe);
  DYNCAL_TRY(read_dut_phase(measurement.dut_phase(), recipe));
  DYNCAL_TRY(read_steps(measurement, recipe).and_then([&] { return check_recipe(recipe); }));
  return recipe;
}

} // namespace dyncal::inline evaluation
