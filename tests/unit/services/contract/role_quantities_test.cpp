#include "services/contract/role_quantities.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

using testing::HasSubstr;

using Units = std::map<std::string, std::string>; // by "source/channel"

RoleNames sample_stamping() {
  return {.method = EvaluationMethod::sample_timestamping,
          .reference = {"acs", "reference"},
          .sync_acs = {"acs", "sync"},
          .sync_sensor = {"dau", "sync"},
          .dut = {{"dau", "acceleration_x"}, {"dau", "acceleration_z"}},
          .temperature = ChannelName{"dau", "temperature"}};
}

const Units usual{{"acs/reference", "m/s^2"},
                  {"acs/sync", "V"},
                  {"dau/sync", "V"},
                  {"dau/acceleration_x", "m/s^2"},
                  {"dau/acceleration_z", "m/s^2"},
                  {"dau/temperature", "degC"}};

std::vector<RoleQuantityProblem> problems_of(const RoleNames& roles, const Units& units,
                                             const std::string& word = "") {
  return find_quantity_problems(
      roles, [&](const ChannelName& name) -> std::optional<drivers::ChannelDescription> {
        const auto unit = units.find(name.text());
        if (unit == units.end()) {
          return std::nullopt;
        }
        drivers::ChannelDescription channel;
        channel.name = name.channel;
        channel.unit = unit->second;
        channel.quantity = name.text() == "acs/reference" ? word : "";
        return channel;
      });
}

std::set<std::string> roles_of(const std::vector<RoleQuantityProblem>& problems) {
  std::set<std::string> roles;
  for (const RoleQuantityProblem& problem : problems) {
    roles.insert(problem.role);
  }
  return roles;
}

Units with(Units units, const std::string& channel, const std::string& unit) {
  units[channel] = unit;
  return units;
}

TEST(RoleQuantities, AreWhatTheRolesAreFor) {
  EXPECT_TRUE(problems_of(sample_stamping(), usual).empty());
  EXPECT_TRUE(problems_of(sample_stamping(), {}).empty()) << "nothing is described yet";
}

TEST(RoleQuantities, ExchangedRolesAreNamedBoth) {
  RoleNames roles = sample_stamping();
  std::swap(roles.reference, roles.sync_acs);
  const auto problems = problems_of(roles, usual);
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].role, "reference");
  EXPECT_EQ(problems[0].sentence,
            "names \"acs/sync\", in V: a voltage, where the quantity of the level is expected, an "
            "acceleration (or a velocity, a displacement, an angular velocity, a force, a "
            "pressure); exchange reference and sync_acs (\"acs/reference\")");
  EXPECT_EQ(problems[1].role, "sync_acs");
  EXPECT_EQ(problems[1].sentence,
            "names \"acs/reference\", in m/s^2: an acceleration, where the voltage of the sync "
            "signal is expected; exchange sync_acs and reference (\"acs/sync\")");
}

// Every exchange of two roles of different quantity, in any units that the quantities have.
TEST(RoleQuantities, EveryExchangeOfQuantitiesIsFound) {
  std::mt19937 random(31);
  const std::vector<std::string> motions{
      "m/s^2", "m/s", "m", "rad/s", "N", "Pa", R"(\degree\second\tothe{-1})"};
  const auto one_of = [&](const std::vector<std::string>& texts) {
    return texts[random() % texts.size()];
  };
  for (int draw = 0; draw < 200; ++draw) {
    const Units units{{"acs/reference", one_of(motions)},
                      {"acs/sync", one_of({"V", "mV", R"(\milli\ampere)"})},
                      {"dau/sync", one_of({"V", "mV"})},
                      {"dau/acceleration_x", one_of(motions)},
                      {"dau/acceleration_z", one_of(motions)},
                      {"dau/temperature", one_of({"degC", "K"})}};
    RoleNames right = sample_stamping();
    right.method = draw % 3 == 0 ? EvaluationMethod::series_timestamping
                                 : EvaluationMethod::sample_timestamping;
    EXPECT_TRUE(problems_of(right, units).empty()) << draw;
    RoleNames wrong = right;
    const std::vector<ChannelName*> others{&wrong.sync_acs, &wrong.sync_sensor,
                                           &*wrong.temperature};
    ChannelName& other = *others[random() % others.size()];
    ChannelName& counterpart =
        random() % 2 == 0 ? wrong.reference : wrong.dut[random() % wrong.dut.size()];
    std::swap(counterpart, other);
    const auto problems = problems_of(wrong, units);
    ASSERT_FALSE(problems.empty()) << draw;
    EXPECT_TRUE(std::ranges::any_of(problems, [](const RoleQuantityProblem& problem) {
      return problem.sentence.find("; exchange ") != std::string::npos;
    })) << problems.front().sentence;
  }
}

// Wanted of every role, unit by unit.
TEST(RoleQuantities, ATableOfRolesAndUnits) {
  struct Row {
    const char* unit;
    std::set<std::string> refused;
  };
  const std::set<std::string> syncs{"sync_acs", "sync_dau"};
  const std::set<std::string> all_but_temperature{"reference", "sync_acs", "sync_dau", "dut"};
  const std::set<std::string> no_motion{"sync_acs", "sync_dau", "temperature"};
  const std::vector<Row> rows{
      {"", {}},
      {"1", {}},
      {"LSB", {}},
      {"g", {}},
      {R"(\percent)", {}},
      {"m/s^2", no_motion},
      {"m/s", no_motion},
      {"m", no_motion},
      {"rad/s", no_motion},
      {"N", no_motion},
      {"Pa", no_motion},
      {"uT", no_motion},
      {"rad", syncs},
      {"V", {"reference", "temperature"}},
      {"mV", {"reference", "temperature"}},
      {R"(\ampere)", {"reference", "temperature"}},
      {R"(\pico\coulomb)", {"reference", "sync_acs", "sync_dau", "temperature"}},
      {"degC", all_but_temperature},
      {"K", all_but_temperature},
      {"s", {"reference", "sync_acs", "sync_dau", "temperature", "dut"}},
  };
  const std::map<std::string, std::string> channels{{"reference", "acs/reference"},
                                                    {"sync_acs", "acs/sync"},
                                                    {"sync_dau", "dau/sync"},
                                                    {"temperature", "dau/temperature"},
                                                    {"dut", "dau/acceleration_z"}};
  for (const Row& row : rows) {
    for (const auto& [role, channel] : channels) {
      const auto problems = problems_of(sample_stamping(), with(usual, channel, row.unit));
      const std::set<std::string> wanted =
          row.refused.contains(role) ? std::set<std::string>{role} : std::set<std::string>{};
      EXPECT_EQ(roles_of(problems), wanted) << role << " in " << row.unit;
    }
  }
}

TEST(RoleQuantities, WithoutSyncTheReferenceMayFindTheSteps) {
  RoleNames roles = sample_stamping();
  roles.method = EvaluationMethod::absolute_time;
  roles.sync_sensor = {};
  EXPECT_TRUE(problems_of(roles, usual).empty());
  roles.sync_acs = roles.reference;
  EXPECT_TRUE(problems_of(roles, usual).empty());
  roles.sync_acs = {};
  EXPECT_TRUE(problems_of(roles, usual).empty());
  EXPECT_EQ(roles_of(problems_of(roles, with(usual, "acs/reference", "V"))),
            std::set<std::string>{"reference"});
}

TEST(RoleQuantities, AnAnalogueSensorMayBeInVolts) {
  const RoleNames roles{.method = EvaluationMethod::analogue,
                        .reference = {"acs", "reference"},
                        .sync_acs = {"acs", "reference"},
                        .sync_sensor = {},
                        .dut = {{"acs", "sync"}}};
  EXPECT_TRUE(problems_of(roles, usual).empty());
}

TEST(RoleQuantities, TheCalibrationOfAnAdcComparesSyncWithSync) {
  RoleNames roles = sample_stamping();
  roles.temperature = {};
  roles.reference = roles.sync_acs;
  roles.dut = {roles.sync_sensor};
  EXPECT_TRUE(problems_of(roles, usual).empty());
  roles.dut = {{"dau", "acceleration_z"}};
  EXPECT_EQ(roles_of(problems_of(roles, usual)), std::set<std::string>{"reference"});
}

TEST(RoleQuantities, WhatTheSourceSaysCountsBesideTheUnitOfTheBenchFile) {
  EXPECT_TRUE(problems_of(sample_stamping(), usual, "Acceleration").empty());
  EXPECT_TRUE(problems_of(sample_stamping(), usual, "Channel 1").empty());
  const auto problems = problems_of(sample_stamping(), usual, "Voltage");
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_THAT(problems[0].sentence, HasSubstr("in m/s^2 by the bench file, but of which its source "
                                              "says \"Voltage\": a voltage"));
  const auto no_unit = problems_of(sample_stamping(), with(usual, "acs/reference", ""), "Voltage");
  ASSERT_EQ(no_unit.size(), 1U);
  EXPECT_THAT(
      no_unit[0].sentence,
      HasSubstr("names \"acs/reference\", of which its source says \"Voltage\": a voltage"));
}

} // namespace
} // namespace dyncal::inline contract
