#include <fmt/core.h>
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

class CheckPrograms : public testing::Test {
protected:
  CheckPrograms() {
    view_.own = {"dyncal-doctor", "lab-1", 1, "dyncal 0.2.0", "cyclonedds"};
    view_.programs = {
        {{"dyncal-analysis", "lab-1", 2, "dyncal 0.2.0", "cyclonedds"}, wire::CONTRACT_VERSION, {}},
        {{"dyncal-acs", "lab-2", 3, "dyncal 0.2.0", "fastdds"}, wire::CONTRACT_VERSION, {}}};
  }

  LaboratoryView view_;
};

TEST_F(CheckPrograms, ListsWhoIsThere) {
  const Findings findings = check_programs(view_);
  EXPECT_THAT(problems(findings), IsEmpty());
  EXPECT_THAT(warnings(findings), IsEmpty());
  EXPECT_EQ(findings.at(1).sentence, "dyncal-acs:3 on lab-2: dyncal 0.2.0, fastdds");
}

TEST_F(CheckPrograms, NamesOthersOfTheDomain) {
  view_.discovery.participants = {{"010f", "my reader", "Fast DDS"},
                                  {"0110", "", "Cyclone DDS"},
                                  {"0110", "dyncal-acs", "Cyclone DDS"}};
  EXPECT_EQ(check_programs(view_).at(2).sentence,
            "also in this domain: my reader (Fast DDS), without a name (Cyclone DDS)");
}

TEST_F(CheckPrograms, SaysThatNothingIsThere) {
  view_.programs.clear();
  view_.domain = 3;
  view_.seconds = 5.0;
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("nothing is on DDS domain 3 for 5 s"),
                          HasSubstr("no analysis service")));
}

TEST_F(CheckPrograms, MissesTheAnalysis) {
  view_.programs.erase(view_.programs.begin());
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("start dyncal-analysis on one machine")));
}

TEST_F(CheckPrograms, NamesVersionsThatDiffer) {
  view_.programs[1].identity.software = "dyncal 0.1.0";
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("different versions: dyncal 0.1.0 (dyncal-acs@lab-2), dyncal "
                                    "0.2.0 (dyncal-analysis@lab-1, dyncal-doctor@lab-1);")));
  view_.programs[1].contract_version = wire::CONTRACT_VERSION + 1;
  EXPECT_THAT(problems(check_programs(view_)),
              ElementsAre(AllOf(
                  HasSubstr("of the contract"),
                  HasSubstr(fmt::format("{} (dyncal-acs@lab-2)", wire::CONTRACT_VERSION + 1)))));
}

TEST_F(CheckPrograms, NamesTheVersionThatAnAnalysisReports) {
  network::Service& analysis = view_.analyses["dyncal-analysis:9@lab-3"];
  analysis.software = "dyncal 0.1.0";
  analysis.host = "lab-3";
  analysis.process_id = 9;
  analysis.contract_version = wire::CONTRACT_VERSION;
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("different versions: dyncal 0.1.0 (dyncal-analysis@lab-3)")));
}

TEST_F(CheckPrograms, NamesTheVersionThatASourceDescribes) {
  network::Source& dau = view_.sources[{"acc-1", "dau"}];
  dau.description.emplace();
  dau.host = "lab-3";
  dau.process_id = 9;
  dau.software = "dyncal 0.1.0";
  dau.contract_version = wire::CONTRACT_VERSION;
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("dyncal 0.1.0 (the source acc-1/dau@lab-3)")));
  dau.host = "lab-2"; // of a program that answers
  dau.process_id = 3;
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("dyncal 0.1.0 (dyncal-acs@lab-2)")));
}

TEST_F(CheckPrograms, NamesEightPlacesOfAVersion) {
  for (std::uint32_t i = 0; i < 20; ++i) {
    view_.programs.push_back({{fmt::format("dyncal-{:02}", i), "lab-2", i, "dyncal 0.1.0", ""},
                              wire::CONTRACT_VERSION,
                              {}});
  }
  EXPECT_THAT(warnings(check_programs(view_)), ElementsAre(HasSubstr("dyncal-07@lab-2, 12 more)")));
}

TEST_F(CheckPrograms, NamesClocksThatAreFarApart) {
  view_.clocks = {{"lab-2", {.offset_s = 0.01, .bound_s = 0.001}}};
  EXPECT_THAT(warnings(check_programs(view_)), IsEmpty());
  view_.clocks = {{"lab-2", {.offset_s = -300.0, .bound_s = 0.001}}};
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("the clock of lab-2 is -300.000000 s from ours")));
}

TEST_F(CheckPrograms, NamesComputersOfOneNameByTheirClocks) {
  DiscoveredProgram& ours = view_.programs.front(); // on lab-1, as the doctor
  ours.clock = {.offset_s = 10.0, .bound_s = 0.001};
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(AllOf(HasSubstr("'lab-1' is the name of two computers"),
                                HasSubstr("dyncal-analysis:2@lab-1"), HasSubstr("9.999 s apart"))));
  ours.clock = {.offset_s = -0.0002, .bound_s = 0.0003};
  EXPECT_THAT(warnings(check_programs(view_)), IsEmpty());
  // Two others, of which neither is far from this one.
  view_.programs.push_back(view_.programs.back());
  view_.programs.back().identity.process_id = 4;
  view_.programs[1].clock = {.offset_s = 0.3, .bound_s = 0.01};
  view_.programs[2].clock = {.offset_s = 0.305, .bound_s = 0.01};
  EXPECT_THAT(warnings(check_programs(view_)), IsEmpty());
  view_.programs[2].clock = {.offset_s = -0.3, .bound_s = 0.01};
  EXPECT_THAT(warnings(check_programs(view_)),
              ElementsAre(HasSubstr("'lab-2' is the name of two computers")));
}

} // namespace
} // namespace dyncal::inline checks::doctor
