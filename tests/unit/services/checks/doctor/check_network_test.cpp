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
using tests::problems;
using tests::warnings;

class CheckNetwork : public testing::Test {
protected:
  CheckNetwork() {
    view_.domain = 1;
    view_.discovery.participants = {{id_, "dyncal-acs", "Cyclone DDS"}};
    view_.discovery.endpoints = {
        {.participant = id_, .topic = "SourceStatus", .type = "", .partitions = {"acc-1"}}};
    view_.programs = {{{"dyncal-acs", "lab-2", 3, "", ""}, 1, {}}};
    view_.announced_by_multicast = {id_};
  }

  const std::string id_ = "01100000000000000000000a";
  LaboratoryView view_;
};

TEST_F(CheckNetwork, IsContentWhereEverythingComes) {
  const Findings findings = check_network(view_);
  EXPECT_THAT(problems(findings), IsEmpty());
  EXPECT_THAT(warnings(findings), IsEmpty());
  EXPECT_EQ(findings.size(), 2U);
}

TEST_F(CheckNetwork, NamesWhoseMulticastDoesNotCome) {
  view_.announced_by_multicast->clear();
  EXPECT_THAT(warnings(check_network(view_)),
              ElementsAre(HasSubstr("no multicast comes from dyncal-acs")));
  view_.announced_by_multicast.reset();
  EXPECT_THAT(warnings(check_network(view_)), IsEmpty()) << "nobody listened for it";
}

TEST_F(CheckNetwork, NamesPortsWhereUnicastDoesNotGetThrough) {
  view_.discovery.endpoints.clear();
  EXPECT_THAT(
      warnings(check_network(view_)),
      ElementsAre(HasSubstr("a firewall on either host must let UDP 7650 to 7723 through")));
}

TEST_F(CheckNetwork, NamesPortsWhereMessagesDoNotGetThrough) {
  view_.programs.clear();
  EXPECT_THAT(problems(check_network(view_)), ElementsAre(HasSubstr("UDP 7650 to 7723")));
}

TEST_F(CheckNetwork, TellsWhoGetsMalformedPacketsFromWhom) {
  view_.seconds = 5.0;
  view_.programs[0].packets_refused = 1200;
  view_.programs[0].packets_refused_now = 1000;
  EXPECT_THAT(warnings(check_network(view_)),
              ElementsAre(AllOf(HasSubstr("dyncal-acs:3 on lab-2 has refused 1200 malformed "
                                          "packets since its start, 1000 of them in these 5 s"),
                                HasSubstr("tcpdump -n udp portrange 7650-7723"),
                                HasSubstr("your own hosts to UDP 7650 to 7723"))));
  view_.programs[0].packets_refused_from = "192.0.2.7";
  EXPECT_THAT(warnings(check_network(view_)),
              ElementsAre(HasSubstr("the last one came from 192.0.2.7")));
}

TEST_F(CheckNetwork, CountsMessagesThatDoNotMatchTheContract) {
  view_.malformed_messages = 4;
  EXPECT_THAT(warnings(check_network(view_)),
              ElementsAre(HasSubstr("4 messages do not match the contract")));
}

} // namespace
} // namespace dyncal::inline checks::doctor
