#include "services/evaluation/recipe/recipe.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/evaluation/recipe/reference_correction.hpp"

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

void add_links(const AnalogueRoles& roles, RoleNames& names) {
  names.sync_acs = roles.excitation;
}
void add_links(const AbsoluteTimeRoles& roles, RoleNames& names) {
  names.sync_acs = roles.excitation;
}
void add_links(const SampleStampingRoles& roles, RoleNames& names) {
  names.sync_acs = roles.sync_acs;
  names.sync_sensor = roles.sync_dau;
}
void add_links(const SeriesRoles& roles, RoleNames& names) {
  names.sync_acs = roles.sync_acs;
  names.sync_sensor = roles.sync_dso;
}

} // namespace

Roles make_roles(RoleNames names, MethodDetails details) {
  const ChannelName excitation = names.sync_acs.source.empty() ? names.reference : names.sync_acs;
  switch (names.method) {
  case EvaluationMethod::analogue:
    return AnalogueRoles{std::move(names.reference), excitation, std::move(names.dut)};
  case EvaluationMethod::absolute_time:
    return AbsoluteTimeRoles{std::move(names.reference), excitation, std::move(names.dut)};
  case EvaluationMethod::series_timestamping:
    return SeriesRoles{std::move(names.reference),
                       std::move(names.sync_acs),
                       std::move(names.sync_sensor),
                       std::move(names.dut),
                       details.shots,
                       details.trigger_phase_correction,
                       details.dso_delay_s,
                       details.u_dso_delay_s,
                       details.u_acs_rate_rel,
                       details.u_dso_rate_rel};
  case EvaluationMethod::sample_timestamping:
    break;
  }
  return SampleStampingRoles{std::move(names.reference),         std::move(names.sync_acs),
                             std::move(names.sync_sensor),       std::move(names.dut),
                             std::move(details.adc_calibration), details.u_adc_delay_s};
}

EvaluationMethod Recipe::method() const {
  struct MethodOf {
    EvaluationMethod operator()(const SampleStampingRoles&) const {
      return EvaluationMethod::sample_timestamping;
    }
    EvaluationMethod operator()(const AnalogueRoles&) const { return EvaluationMethod::analogue; }
    EvaluationMethod operator()(const SeriesRoles&) const {
      return EvaluationMethod::series_timestamping;
    }
    EvaluationMethod operator()(const AbsoluteTimeRoles&) const {
      return EvaluationMethod::absolute_time;
    }
  };
  return std::visit(MethodOf{}, roles);
}

const ChannelName& Recipe::reference() const {
  return std::visit([](const auto& one) -> const ChannelName& { return one.reference; }, roles);
}

const std::vector<ChannelName>& Recipe::dut() const {
  return std::visit([](const auto& one) -> const std::vector<ChannelName>& { return one.dut; },
                    roles);
}

RoleNames role_names(const Recipe& recipe) {
  RoleNames names{.method = recipe.method(),
                  .reference = recipe.reference(),
                  .sync_acs = {},
                  .sync_sensor = {},
                  .dut = recipe.dut(),
                  .temperature = recipe.temperature.value_or(ChannelName{})};
  std::visit([&](const auto& roles) { add_links(roles, names); }, recipe.roles);
  return names;
}

std::vector<ChannelName> Recipe::channels() const {
  RoleNames names = role_names(*this);
  std::vector<ChannelName> all{std::move(names.reference), std::move(names.sync_acs)};
  if (!names.sync_sensor.source.empty()) {
    all.push_back(std::move(names.sync_sensor));
  }
  all.insert(all.end(), names.dut.begin(), names.dut.end());
  if (temperature) {
    all.push_back(*temperature);
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
  if (const auto problem = find_role_problem(role_names(recipe))) {
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
  for (const RecipeStep& step : recipe.steps) {
    if (const auto reference = reference_response(recipe, step); !reference) {
      return refuse(fmt::format("step {} of the recipe: {}", step.step, reference.error().message));
    }
  }
  if (recipe.whole_record && recipe.steps.size() != 1) {
    return refuse(
        fmt::format("the recipe evaluates whole records but has {} steps; only one is possible",
                    recipe.steps.size()));
  }
  const auto* const stamped = std::get_if<SampleStampingRoles>(&recipe.roles);
  const bool own_clocks = stamped != nullptr ? stamped->own_clocks()
                                             : recipe.method() == EvaluationMethod::absolute_time;
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

} // namespace dyncal::inline evaluation
