#include "services/contract/role_quantities.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/contract/quantity.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline contract {
namespace {

struct Expectation {
  bool (*accepts)(Quantity);
  const char* text;
};

bool is_electrical(Quantity quantity) {
  return quantity == Quantity::voltage || quantity == Quantity::current ||
         quantity == Quantity::charge || quantity == Quantity::other_electrical;
}

constexpr Expectation of_the_level{
    [](Quantity quantity) {
      return !is_electrical(quantity) && quantity != Quantity::temperature &&
             quantity != Quantity::time;
    },
    "the quantity of the level is expected, an acceleration (or a velocity, a displacement, an "
    "angular velocity, a force, a pressure)"};

constexpr Expectation of_sync{[](Quantity quantity) {
                                return quantity == Quantity::voltage ||
                                       quantity == Quantity::current;
                              },
                              "the voltage of the sync signal is expected"};

constexpr Expectation of_steps{[](Quantity quantity) {
                                 return quantity != Quantity::temperature &&
                                        quantity != Quantity::time;
                               },
                               "a signal that shows the excitation is expected"};

// An angle: "deg" is written for both.
constexpr Expectation of_temperature{[](Quantity quantity) {
                                       return quantity == Quantity::temperature ||
                                              quantity == Quantity::angle;
                                     },
                                     "a temperature is expected"};

constexpr Expectation of_sensor{of_steps.accepts, "what the sensor measures is expected"};

struct Role {
  std::string name;
  std::size_t entry = 0;
  ChannelName channel;
  Expectation expected;
  std::string unit{};
  std::string word{};
  Quantity by_unit = Quantity::unknown;
  Quantity by_word = Quantity::unknown;

  [[nodiscard]] bool is_known() const {
    return by_unit != Quantity::unknown || by_word != Quantity::unknown;
  }
};

bool contradicts(const Expectation& expected, Quantity quantity) {
  return quantity != Quantity::unknown && !expected.accepts(quantity);
}

bool contradicts(const Expectation& expected, const Role& role) {
  return contradicts(expected, role.by_unit) || contradicts(expected, role.by_word);
}

bool compares_with_itself(const RoleNames& roles) {
  return !is_without_sync(roles.method) && roles.reference == roles.sync_acs &&
         roles.dut.size() == 1 && roles.dut.front() == roles.sync_sensor;
}

std::vector<Role> roles_in(const RoleNames& names) {
  const bool no_sync = is_without_sync(names.method);
  const bool by_series = names.method == EvaluationMethod::series_timestamping;
  std::vector<Role> roles{{"reference", 0, names.reference, of_the_level}};
  if (!no_sync || names.sync_acs != names.reference) {
    roles.push_back({"sync_acs", 0, names.sync_acs, no_sync ? of_steps : of_sync});
  }
  if (!no_sync) {
    roles.push_back({by_series ? "sync_dso" : "sync_dau", 0, names.sync_sensor, of_sync});
  }
  if (names.temperature) {
    roles.push_back({"temperature", 0, *names.temperature, of_temperature});
  }
  for (std::size_t i = 0; i < names.dut.size(); ++i) {
    roles.push_back({"dut", i, names.dut[i], of_sensor});
  }
  std::erase_if(roles, [](const Role& role) { return role.channel.source.empty(); });
  return roles;
}

void add_quantity(const DescribedChannel& described, Role& role) {
  const auto channel = described(role.channel);
  if (!channel) {
    return;
  }
  role.unit = channel->unit;
  role.word = channel->quantity;
  role.by_unit = quantity_of_unit(channel->unit);
  role.by_word = quantity_of_word(channel->quantity);
}

// "in V: a voltage"
std::string what_is_there(const Role& role) {
  if (contradicts(role.expected, role.by_unit)) {
    return fmt::format("in {}: {}", short_form(role.unit), to_string(role.by_unit));
  }
  const bool differs = role.by_unit != Quantity::unknown;
  return fmt::format("{}of which its source says \"{}\": {}",
                     differs ? fmt::format("in {} by the bench file, but ", short_form(role.unit))
                             : std::string(),
                     short_form(role.word), to_string(role.by_word));
}

// Empty: no exchange makes both right.
std::string remedy(const Role& wrong, const std::vector<Role>& roles) {
  const auto other = std::ranges::find_if(roles, [&](const Role& one) {
    return one.name != wrong.name && one.is_known() && !contradicts(wrong.expected, one) &&
           !contradicts(one.expected, wrong);
  });
  return other == roles.end() ? ""
                              : fmt::format("; exchange {} and {} (\"{}\")", wrong.name,
                                            other->name, other->channel.text());
}

} // namespace

std::vector<RoleQuantityProblem> find_quantity_problems(const RoleNames& names,
                                                        const DescribedChannel& described) {
  if (compares_with_itself(names)) {
    return {};
  }
  std::vector<Role> roles = roles_in(names);
  for (Role& role : roles) {
    add_quantity(described, role);
  }
  std::vector<RoleQuantityProblem> problems;
  for (const Role& role : roles) {
    if (contradicts(role.expected, role)) {
      problems.push_back(
          {role.name, role.entry,
           fmt::format("names \"{}\", {}, where {}{}", role.channel.text(), what_is_there(role),
                       role.expected.text, remedy(role, roles))});
    }
  }
  return problems;
}

} // namespace dyncal::inline contract
