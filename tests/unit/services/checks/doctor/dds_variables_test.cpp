#include "services/checks/doctor/dds_variables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "services/checks/doctor/host_view.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "tests/unit/services/checks/doctor/findings.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using tests::warnings;

TEST(DdsVariables, AreReadFromTheEnvironment) {
  setenv("ROS_DISCOVERY_SERVER", "192.0.2.1:11811", 1);
  setenv("CYCLONEDDS_URI", "", 1);
  EXPECT_THAT(dds_variables(), ElementsAre(Pair("ROS_DISCOVERY_SERVER", "192.0.2.1:11811")));
  unsetenv("ROS_DISCOVERY_SERVER");
  unsetenv("CYCLONEDDS_URI");
}

TEST(DdsVariables, AreAWarningWhereTheyMayBeWhyNobodyIsFound) {
  LaboratoryView view;
  HostView host;
  EXPECT_THAT(check_variables(view, host), IsEmpty());
  host.dds_variables = {{"CYCLONEDDS_URI", "x.xml"}, {"ROS_DOMAIN_ID", "7"}};
  view.own.dds = "cyclonedds";
  EXPECT_THAT(warnings(check_variables(view, host)),
              ElementsAre(AllOf(HasSubstr("CYCLONEDDS_URI is set here to 'x.xml'"),
                                HasSubstr("every program of cyclonedds"))));
  view.own.dds = "fastdds";
  EXPECT_THAT(warnings(check_variables(view, host)), IsEmpty());
  EXPECT_EQ(check_variables(view, host).size(), 2U) << "notes";
  view.own.dds = "cyclonedds";
  view.programs.emplace_back();
  EXPECT_THAT(warnings(check_variables(view, host)), IsEmpty());
}

} // namespace
} // namespace dyncal::inline checks::doctor
