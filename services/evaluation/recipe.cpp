#include "services/evaluation/recipe.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace dyncal::services {
namespace {

Error refused(std::string message) {
  return {ErrorCode::bad_argument, std::move(message)};
}

Expected<ChannelName> role(const std::string& what, const std::string& text) {
  if (const auto name = parse_channel_name(text)) {
    return *name;
  }
  return fail(
      refused(fmt::format("the recipe's {} is \"{}\" but must be \"source/channel\"", what, text)));
}

Expected<void> check_roles(const Recipe& recipe) {
  if (recipe.without_sync() && recipe.dut.empty()) {
    return fail(refused("the recipe names no channel under calibration, which a method "
                        "without sync needs: give \"dut\""));
  }
  if (recipe.reference.source != recipe.sync_acs.source) {
    return fail(refused("the recipe's reference and sync_acs are of different sources, "
                        "but they must share a clock"));
  }
  if (recipe.sync_dau.source == recipe.sync_acs.source) {
    return fail(refused("the recipe's sync_acs and sync_dau are of the same source; "
                        "sample time stamping links two clocks"));
  }
  if (recipe.method == wire::METHOD_ANALOGUE &&
      recipe.dut_sources() != std::vector{recipe.reference.source}) {
    return fail(refused("the recipe's channels under calibration must be of the source "
                        "of the reference: the analogue method "
                        "compares channels of one system"));
  }
  const bool beside = recipe.stamped_apart();
  for (const ChannelName& name : recipe.dut) {
    const bool of_dau = name.source == recipe.sync_dau.source;
    if (recipe.method == wire::METHOD_SAMPLE_TIMESTAMPING && of_dau == beside) {
      return fail(refused("the recipe's channels under calibration must be either all of "
                          "the source of sync_dau or none of them"));
    }
  }
  return {};
}

Expected<void> parse_roles(const wire::Measurement& measurement, Recipe& recipe) {
  const bool by_series = recipe.method == wire::METHOD_SERIES_TIMESTAMPING;
  const std::vector<std::pair<const char*, std::pair<const std::string*, ChannelName*>>> roles{
      {"reference", {&measurement.reference(), &recipe.reference}},
      {"sync_acs", {&measurement.sync_acs(), &recipe.sync_acs}},
      {by_series ? "sync_dso" : "sync_dau",
       {by_series ? &measurement.sync_dso() : &measurement.sync_dau(), &recipe.sync_dau}}};
  const bool without_sync = recipe.without_sync();
  for (const auto& [what, places] : roles) {
    if (without_sync && places.first->empty()) {
      continue; // the steps are found in the reference itself
    }
    const auto name = role(what, *places.first);
    if (!name) {
      return fail(name.error());
    }
    *places.second = *name;
  }
  for (const std::string& text : measurement.dut()) {
    const auto name = role("dut", text);
    if (!name) {
      return fail(name.error());
    }
    recipe.dut.push_back(*name);
  }
  if (!measurement.temperature().empty()) {
    const auto name = role("temperature", measurement.temperature());
    if (!name) {
      return fail(name.error());
    }
    recipe.temperature = *name;
  }
  if (without_sync && recipe.sync_acs.source.empty()) {
    recipe.sync_acs = recipe.reference;
  }
  if (without_sync) {
    recipe.sync_dau = {};
  }
  return check_roles(recipe);
}

Expected<void> parse_steps(const wire::Measurement& measurement, Recipe& recipe) {
  for (const wire::PlannedStep& planned : measurement.steps()) {
    const auto frequency = analysis::Frequency::parse(planned.frequency_text_hz());
    if (!frequency || !(planned.duration_s() > 0.0) || !(planned.settling_s() >= 0.0)) {
      return fail(refused(
          fmt::format("step {} of the recipe has frequency \"{}\", settling {} s, duration {} s",
                      planned.step(), planned.frequency_text_hz(), planned.settling_s(),
                      planned.duration_s())));
    }
    recipe.steps.push_back({planned.step(), planned.repetition(), planned.frequency_text_hz(),
                            *frequency, planned.level_m_s2(), planned.settling_s(),
                            planned.duration_s()});
  }
  if (recipe.steps.empty()) {
    return fail(refused("the recipe has no excitation steps"));
  }
  return {};
}

} // namespace

bool Recipe::stamped_apart() const {
  return method == wire::METHOD_ABSOLUTE_TIME ||
         (method == wire::METHOD_SAMPLE_TIMESTAMPING && !dut.empty() &&
          dut.front().source != sync_dau.source);
}

std::vector<std::string> Recipe::dut_sources() const {
  std::vector<std::string> names;
  for (const ChannelName& channel : dut) {
    if (std::find(names.begin(), names.end(), channel.source) == names.end()) {
      names.push_back(channel.source);
    }
  }
  return names;
}

std::vector<std::string> Recipe::sources() const {
  std::vector<std::string> names{reference.source};
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  };
  add(sync_dau.source);
  for (const ChannelName& channel : dut) {
    add(channel.source);
  }
  if (temperature) {
    add(temperature->source);
  }
  return names;
}

Expected<Recipe> parse_recipe(const wire::Measurement& measurement) {
  Recipe recipe;
  recipe.method = measurement.method();
  if (recipe.method > wire::METHOD_ABSOLUTE_TIME) {
    return fail(refused(fmt::format("the recipe's method has number {}, which this version does "
                                    "not know; update dyncal-analysis",
                                    static_cast<std::uint32_t>(recipe.method))));
  }
  recipe.dso_delay_s = measurement.dso_delay_s();
  recipe.u_dso_delay_s = measurement.u_dso_delay_s();
  recipe.shots = measurement.shots();
  recipe.trigger_phase_correction = measurement.trigger_phase_correction();
  recipe.u_acs_rate_rel = measurement.u_acs_rate_rel();
  recipe.bench = measurement.bench().to_string();
  recipe.run = measurement.run().to_string();
  if (const auto roles = parse_roles(measurement, recipe); !roles) {
    return fail(roles.error());
  }
  if (recipe.method == wire::METHOD_SERIES_TIMESTAMPING && recipe.dut.empty()) {
    return fail(refused("the recipe of a series time stamping names no channel under calibration"));
  }
  if (const auto steps = parse_steps(measurement, recipe); !steps) {
    return fail(steps.error());
  }
  for (const wire::AdcCalibrationPoint& point : measurement.adc_calibration()) {
    recipe.adc_calibration.push_back({point.frequency_hz(), point.test_amplitude_vpp(),
                                      point.gain(), point.phase_lag_rad(), point.u_gain(),
                                      point.u_phase_lag_rad()});
  }
  recipe.whole_record = measurement.whole_record();
  recipe.settling_from_data = measurement.settling_from_data();
  recipe.monte_carlo_trials = measurement.monte_carlo_trials();
  if (recipe.whole_record && recipe.steps.size() != 1) {
    return fail(refused(
        fmt::format("the recipe evaluates whole records but has {} steps; only one is possible",
                    recipe.steps.size())));
  }
  if (measurement.frequency_exact()) {
    recipe.frequency_search_rel = 0.0;
  } else if (measurement.frequency_search_rel() > 0.0) {
    recipe.frequency_search_rel = measurement.frequency_search_rel();
  }
  recipe.reference_delay_s = measurement.reference_delay_s();
  recipe.systematic.reference_magnitude_rel = measurement.u_reference_magnitude_rel();
  recipe.systematic.reference_phase_rad = measurement.u_reference_phase_rad();
  recipe.systematic.acs_delay_s = measurement.u_acs_delay_s();
  recipe.sha256 = measurement.recipe_sha256();
  if (recipe.method == wire::METHOD_SERIES_TIMESTAMPING &&
      (recipe.settling_from_data || recipe.monte_carlo_trials > 0)) {
    return fail(
        refused("series time stamping has neither settling = \"from-data\" nor monte_carlo_trials; "
                "leave them out of the bench file"));
  }
  if (recipe.stamped_apart() && recipe.settling_from_data) {
    return fail(refused("sensors with stamps of their own are evaluated without settling "
                        "= \"from-data\"; leave it out of the "
                        "bench file and give the longest settling as settling_s"));
  }
  return recipe;
}

} // namespace dyncal::services
