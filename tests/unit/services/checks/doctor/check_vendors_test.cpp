#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "tests/unit/services/checks/doctor/findings.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class CheckVendors : public testing::Test {
protected:
  CheckVendors() {
    view_.own.dds = "cyclonedds";
    view_.discovery.participants = {{"a", "dyncal-acs", "Cyclone DDS"}, {"b", "", "Cyclone DDS"}};
  }

  LaboratoryView view_;
};

TEST_F(CheckVendors, SayWhenOneWouldDo) {
  const Findings findings = check_vendors(view_, false);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::ok);
  EXPECT_THAT(findings[0].sentence, AllOf(HasSubstr("all 3 participants have cyclonedds"),
                                          HasSubstr("--vendors same would do")));
  const Findings said = check_vendors(view_, true);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0].sentence, Not(HasSubstr("would do")));
}

TEST_F(CheckVendors, NamesWhoHasAnotherOneWhereThereIsSaidToBeOne) {
  view_.discovery.participants.push_back({"c", "logger", "Fast DDS"});
  view_.discovery.participants.push_back({"d", "", "vendor 01.16"});
  EXPECT_THAT(check_vendors(view_, false), IsEmpty());
  EXPECT_THAT(tests::warnings(check_vendors(view_, true)),
              ElementsAre(AllOf(HasSubstr("a program (vendor 01.16), logger (Fast DDS) may miss"),
                                Not(HasSubstr("dyncal-acs")))));
}

TEST_F(CheckVendors, SayNothingOfAProgramAlone) {
  view_.discovery.participants.clear();
  EXPECT_THAT(check_vendors(view_, false), IsEmpty());
  EXPECT_THAT(check_vendors(view_, true), IsEmpty());
}

} // namespace
} // namespace dyncal::inline checks::doctor
