#include "services/checks/doctor/unheard_analysis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline checks::doctor {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class UnheardAnalysis : public testing::Test {
protected:
  UnheardAnalysis() {
    host_.interfaces = {{.name = "lo", .address = "127.0.0.1", .loopback = true},
                        {.name = "lab", .address = "10.98.0.3"}};
    host_.link_changes_before = host_.link_changes_after = {{"lab", 2}, {"lo", 0}};
    view_.domain = 7;
    view_.announced_by_multicast.emplace();
    view_.announced_from = {"10.98.0.3"}; // our own
  }
  [[nodiscard]] std::string why() const { return why_no_analysis_is_heard(view_, host_); }
  void answer(const std::string& program) {
    DiscoveredProgram heard;
    heard.identity.program = program;
    heard.identity.host = "lab-2";
    view_.programs.push_back(heard);
  }

  LaboratoryView view_;
  HostView host_;
};

TEST_F(UnheardAnalysis, NamesTheOwnAddressesWhereNothingIsHeard) {
  EXPECT_EQ(why(), "nothing is heard in DDS domain 7, by multicast neither: where the network "
                   "carries no multicast, each program needs --peer with the address of the "
                   "others; this host is 10.98.0.3 (lab)");
}

TEST_F(UnheardAnalysis, NamesWhoAnswersInstead) {
  answer("dyncal-dau");
  EXPECT_THAT(why(), AllOf(HasSubstr("dyncal-dau on lab-2 answers, but no dyncal-analysis"),
                           HasSubstr("10.98.0.3 (lab)")));
}

TEST_F(UnheardAnalysis, TellsAWayThatIsCutInOneDirection) {
  view_.announced_from.insert("10.98.0.1");
  EXPECT_THAT(why(), HasSubstr("announcements come from 10.98.0.1, but no answer"));
  view_.discovery.participants = {{"0110", "dyncal-analysis", "Cyclone DDS"}};
  EXPECT_THAT(why(), HasSubstr("announcements come from 10.98.0.1, of a dyncal-analysis too"));
}

TEST_F(UnheardAnalysis, TellsALinkThatIsOverloadedFromAWayThatIsCut) {
  view_.announced_from.insert("10.98.0.1");
  host_.tried["10.98.0.1"] = {.begun = 40, .in_time = 3, .late = 9};
  EXPECT_THAT(why(), AllOf(HasSubstr("the link is overloaded or bad: of 40 trial connections to "
                                     "10.98.0.1 3 were answered in time, 9 late"),
                           Not(HasSubstr("firewall"))));
  host_.tried["10.98.0.1"] = {.begun = 40, .in_time = 0, .late = 40}; // deep queues
  EXPECT_THAT(why(), AllOf(HasSubstr("overloaded"), Not(HasSubstr("firewall"))));
  host_.tried["10.98.0.1"] = {.begun = 40, .in_time = 0, .late = 0};
  EXPECT_THAT(why(),
              AllOf(HasSubstr("a way that is cut in one direction"), Not(HasSubstr("overloaded"))));
}

TEST_F(UnheardAnalysis, TellsAnOverloadedWayBackFromWhichNothingComes) {
  host_.tried["10.98.0.1"] = {.begun = 40, .in_time = 9, .late = 20}; // named with --peer
  EXPECT_THAT(why(), AllOf(HasSubstr("nothing is heard in DDS domain 7, by multicast neither: the "
                                     "link is overloaded or bad: of 40 trial connections to "
                                     "10.98.0.1 9 were answered in time"),
                           Not(HasSubstr("--peer"))));
  for (const unsigned in_time : {0U, 40U}) { // it is off, or hears programs of its own alone
    host_.tried["10.98.0.1"] = {.begun = 40, .in_time = in_time, .late = 0};
    EXPECT_THAT(why(), AllOf(HasSubstr("--peer"), Not(HasSubstr("overloaded"))));
  }
}

TEST_F(UnheardAnalysis, TellsAFirewallThatLetsTcpThrough) {
  view_.announced_from.insert("10.98.0.1");
  host_.tried["10.98.0.1"] = {.begun = 40, .in_time = 40, .late = 0};
  EXPECT_THAT(why(), AllOf(HasSubstr("does not let UDP through"), Not(HasSubstr("overloaded"))));
}

TEST_F(UnheardAnalysis, TellsAnAddressOfAnotherNetwork) {
  view_.announced_from.insert("192.0.2.7");
  host_.tried["192.0.2.7"] = {.begun = 40, .has_no_route = true};
  EXPECT_THAT(why(), AllOf(HasSubstr("no route to 192.0.2.7"), Not(HasSubstr("firewall"))));
}

TEST_F(UnheardAnalysis, JudgesEachHostByItself) {
  view_.announced_from = {"10.98.0.1", "10.98.0.2", "10.98.0.3"};
  host_.tried["10.98.0.1"] = {.begun = 40, .in_time = 40, .late = 0};
  host_.tried["10.98.0.2"] = {.begun = 40, .in_time = 0, .late = 0};
  EXPECT_THAT(why(),
              AllOf(HasSubstr("trial connections to 10.98.0.2"), Not(HasSubstr("overloaded"))));
}

TEST_F(UnheardAnalysis, NamesTheDomainThatProgramsAreIn) {
  view_.announced_elsewhere = {{9, "0110", "dyncal-analysis", "10.98.0.1", "lab"},
                               {0, "010f", "", "10.98.0.9", "lab"}}; // no program of dyncal
  EXPECT_THAT(why(), AllOf(HasSubstr("dyncal-analysis announces itself in DDS domain 9, from "
                                     "10.98.0.1: give --domain 9"),
                           Not(HasSubstr("10.98.0.9"))));
  answer("dyncal-dau");
  EXPECT_THAT(why(), HasSubstr("no dyncal-analysis is among them: dyncal-analysis announces"));
}

TEST_F(UnheardAnalysis, NamesTheInterfaceThatProgramsAreAt) {
  view_.announced_elsewhere = {{7, "0110", "dyncal-analysis", "10.99.0.1", "other"}};
  EXPECT_THAT(why(), HasSubstr("on the network of interface other, from 10.99.0.1, and this "
                               "program uses another one: give --interface other"));
}

TEST_F(UnheardAnalysis, NamesAnInterfaceThatDoesNotLeadToAPeer) {
  host_.used_address = "10.98.0.3";
  host_.tried["10.99.0.1"] = {.begun = 40, .in_time = 40, .own_address = "10.99.0.3"};
  EXPECT_THAT(why(), HasSubstr("10.99.0.1 is reached by 10.99.0.3, and this program uses "
                               "10.98.0.3 alone"));
  host_.used_address = "10.99.0.3";
  EXPECT_THAT(why(), Not(HasSubstr("is reached by")));
}

TEST_F(UnheardAnalysis, NamesAnotherSubnet) {
  host_.interfaces[0].prefix_bits = 8;
  host_.interfaces[1].prefix_bits = 24;
  view_.announced_from.insert("10.97.0.1");
  host_.tried["10.97.0.1"] = {.begun = 40};
  EXPECT_THAT(why(), HasSubstr("10.97.0.1 is at this network, but of another subnet"));
  host_.interfaces[1].prefix_bits = 8;
  EXPECT_THAT(why(), AllOf(Not(HasSubstr("subnet")), HasSubstr("firewall")));
}

TEST_F(UnheardAnalysis, TellsAFullQueueOfThisHost) {
  host_.queues_before = {{"lab", {1000, 10}}, {"lo", {0, 0}}};
  host_.queues_after = {{"lab", {1300, 710}}, {"lo", {0, 0}}};
  EXPECT_THAT(why(), HasSubstr("the link of lab is overloaded: 70 % of what this host sent"));
  host_.queues_after["lab"] = {1'010'000, 510}; // a large transfer beside
  EXPECT_THAT(why(), HasSubstr("nothing is heard"));
  host_.queues_after["lab"] = {1010, 15}; // chance
  EXPECT_THAT(why(), HasSubstr("nothing is heard"));
}

TEST_F(UnheardAnalysis, TellsALinkThatFlaps) {
  view_.announced_from.insert("10.98.0.1");
  host_.link_changes_after["lab"] = 8;
  EXPECT_THAT(why(), HasSubstr("the link of lab went down or came back 6 times"));
}

TEST_F(UnheardAnalysis, TellsALinkThatIsOverloaded) {
  answer("dyncal-analysis");
  view_.losses = {{.answers_probes = true, .sent = 100, .echoed = 60},
                  {.answers_probes = true, .sent = 100, .echoed = 98}};
  EXPECT_THAT(why(), HasSubstr("40 % of the probes from this host to the others bring no echo"));
}

TEST_F(UnheardAnalysis, TellsAHostWithoutIpv4) {
  host_.interfaces.pop_back();
  EXPECT_THAT(why(), AllOf(HasSubstr("no IPv4 address"), Not(HasSubstr("IPv6"))));
  host_.without_ipv4 = {"lab"};
  EXPECT_THAT(why(), HasSubstr("lab has IPv6 alone"));
}

TEST_F(UnheardAnalysis, SaysThatOneAnswersNow) {
  answer("dyncal-analysis");
  EXPECT_TRUE(analysis_is_heard(view_));
  EXPECT_THAT(why(), HasSubstr("answers now"));
}

} // namespace
} // namespace dyncal::inline checks::doctor
