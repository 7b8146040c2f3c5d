#include "services/contract/role_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

using testing::HasSubstr;

RoleNames sample_stamping() {
  return {.method = EvaluationMethod::sample_timestamping,
          .reference = {"acs", "reference"},
          .sync_acs = {"acs", "sync"},
          .sync_sensor = {"dau", "sync"},
          .dut = {{"dau", "acceleration_z"}}};
}

std::string role_of(const std::optional<RoleProblem>& problem) {
  return problem ? problem->role : "none";
}

TEST(RoleRules, AcceptTheRolesOfEveryMethod) {
  RoleNames roles = sample_stamping();
  EXPECT_EQ(role_of(find_role_problem(roles)), "none");
  roles.dut.clear(); // all channels of the DAU
  EXPECT_EQ(role_of(find_role_problem(roles)), "none");
  roles.dut = {{"can", "x"}, {"other", "x"}}; // with stamps of their own
  EXPECT_EQ(role_of(find_role_problem(roles)), "none");
  roles.method = EvaluationMethod::absolute_time;
  roles.sync_acs = {};
  roles.sync_sensor = {};
  EXPECT_EQ(role_of(find_role_problem(roles)), "none");
  roles.method = EvaluationMethod::analogue;
  roles.dut = {{"acs", "sensor"}};
  EXPECT_EQ(role_of(find_role_problem(roles)), "none");
}

TEST(RoleRules, ReferenceAndSyncShareAClock) {
  RoleNames roles = sample_stamping();
  roles.sync_acs = {"other", "sync"};
  EXPECT_EQ(role_of(find_role_problem(roles)), "sync_acs");
}

TEST(RoleRules, TheMethodsWithSyncLinkTwoClocks) {
  RoleNames roles = sample_stamping();
  roles.sync_sensor = {"acs", "sync"};
  EXPECT_EQ(role_of(find_role_problem(roles)), "sync_dau");
  roles.method = EvaluationMethod::series_timestamping;
  EXPECT_EQ(role_of(find_role_problem(roles)), "sync_dso");
}

TEST(RoleRules, AllMethodsButSampleTimeStampingNeedTheirSensors) {
  for (const auto method : {EvaluationMethod::analogue, EvaluationMethod::absolute_time,
                            EvaluationMethod::series_timestamping}) {
    RoleNames roles = sample_stamping();
    roles.method = method;
    roles.dut.clear();
    const auto problem = find_role_problem(roles);
    EXPECT_EQ(role_of(problem), "dut") << to_string(method);
    EXPECT_THAT(problem->sentence, HasSubstr("names no channel under calibration"));
  }
}

TEST(RoleRules, TheAnalogueMethodComparesChannelsOfOneSystem) {
  RoleNames roles = sample_stamping();
  roles.method = EvaluationMethod::analogue;
  EXPECT_THAT(find_role_problem(roles)->sentence, HasSubstr("those of source 'acs'"));
}

TEST(RoleRules, SensorsShareTheStampsOfTheDauOrHaveTheirOwn) {
  RoleNames roles = sample_stamping();
  roles.dut.push_back({"can", "x"});
  EXPECT_THAT(find_role_problem(roles)->sentence,
              HasSubstr("\"dau/acceleration_z\" and \"can/x\""));
}

TEST(RoleRules, SeriesTimeStampingCalibratesOneSensorAtATime) {
  RoleNames roles = sample_stamping();
  roles.method = EvaluationMethod::series_timestamping;
  roles.dut = {{"tss", "x"}, {"other", "x"}};
  EXPECT_THAT(find_role_problem(roles)->sentence, HasSubstr("one sensor at a time"));
}

TEST(RoleRules, AChannelHasOneRole) {
  const auto with = [](auto change) {
    RoleNames roles = sample_stamping();
    change(roles);
    return find_repeated_channel(roles);
  };
  const auto sync_is_reference = with([](RoleNames& r) { r.sync_acs = r.reference; });
  EXPECT_EQ(role_of(sync_is_reference), "sync_acs");
  EXPECT_THAT(sync_is_reference->sentence, HasSubstr("\"acs/reference\", which is reference"));
  EXPECT_EQ(role_of(with([](RoleNames& r) { r.dut = {r.sync_sensor}; })), "dut");
  EXPECT_EQ(role_of(with([](RoleNames& r) { r.dut.push_back(r.dut.front()); })), "dut");
  EXPECT_EQ(role_of(with([](RoleNames& r) { r.temperature = r.dut.front(); })), "temperature");
  EXPECT_EQ(role_of(with([](RoleNames& r) { r.temperature = r.sync_sensor; })), "temperature");
  EXPECT_EQ(role_of(with([](RoleNames& r) {
              r.method = EvaluationMethod::analogue;
              r.sync_sensor = {};
              r.dut = {r.reference};
            })),
            "dut");
}

TEST(RoleRules, WithoutSyncTheStepsMayBeFoundInTheReference) {
  RoleNames roles = sample_stamping();
  roles.method = EvaluationMethod::analogue;
  roles.sync_sensor = {};
  roles.sync_acs = roles.reference;
  roles.dut = {{"acs", "sensor"}};
  EXPECT_EQ(role_of(find_repeated_channel(roles)), "none");
}

} // namespace
} // namespace dyncal::inline contract
