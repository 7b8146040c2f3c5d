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
using tests::sentences;
using tests::warnings;

class CheckLoss : public testing::Test {
protected:
  CheckLoss() { view_.own = {"dyncal-doctor", "lab-1", 1, "", ""}; }
  void add(std::uint64_t sent, std::uint64_t echoed, const std::string& host = "lab-2") {
    view_.losses.push_back({.identity = {"dyncal-acs", host, 3, "", ""},
                            .answers_probes = true,
                            .sent = sent,
                            .echoed = echoed});
  }
  [[nodiscard]] std::vector<std::string> fine() const {
    return sentences(check_loss(view_), Severity::ok);
  }

  LaboratoryView view_;
};

TEST_F(CheckLoss, StatesThePathToEveryProgram) {
  add(200, 198);
  add(180, 179, "lab-3");
  EXPECT_THAT(warnings(check_loss(view_)), IsEmpty()) << "1 % is not more than 1 %";
  EXPECT_THAT(fine(),
              ElementsAre("loss: dyncal-acs:3 on lab-2: 1.0 % of 200 probes brought no echo",
                          "loss: dyncal-acs:3 on lab-3: 0.6 % of 180 probes brought no "
                          "echo"));
}

TEST_F(CheckLoss, WarnsAndSaysWhereToLook) {
  add(200, 197);
  EXPECT_THAT(
      warnings(check_loss(view_)),
      ElementsAre(AllOf(HasSubstr("1.5 % of 200 probes brought no echo"), HasSubstr("switch ports"),
                        HasSubstr("tc -s qdisc"), HasSubstr("no room on lab-2 or here (`nstat"),
                        Not(HasSubstr("none gets through")))));
}

TEST_F(CheckLoss, WarnsOfLossWithinTheHostWithoutCables) {
  add(200, 50, "lab-1");
  EXPECT_THAT(warnings(check_loss(view_)),
              ElementsAre(AllOf(HasSubstr("no room on it (`nstat"), Not(HasSubstr("cable")))));
}

TEST_F(CheckLoss, NamesAWayThatDropsLongPackets) {
  add(200, 200);
  view_.losses.front().long_sent = 50;
  EXPECT_THAT(
      tests::problems(check_loss(view_)),
      ElementsAre(AllOf(HasSubstr("dyncal-acs:3 on lab-2: none of 50 packets"), HasSubstr("MTU"))));
  view_.losses.front().long_echoed = 1;
  EXPECT_THAT(tests::problems(check_loss(view_)), IsEmpty()) << "long ones get through";
  view_.losses = {};
  add(200, 10);
  view_.losses.front().long_sent = 50;
  EXPECT_THAT(tests::problems(check_loss(view_)), IsEmpty()) << "nearly nothing gets through";
}

TEST_F(CheckLoss, TellsThatNothingGetsThroughAlthoughAnswersDo) {
  add(200, 0);
  EXPECT_THAT(warnings(check_loss(view_)),
              ElementsAre(AllOf(HasSubstr("100.0 % of 200 probes brought no echo"),
                                HasSubstr("none gets through, although"))));
}

TEST_F(CheckLoss, TellsWhereNothingCouldBeMeasured) {
  EXPECT_THAT(fine(), ElementsAre(HasSubstr("not measured: no service answers")));
  view_.losses = {{.identity = {"dyncal-dau", "lab-4", 3, "", ""}}};
  add(12, 0);
  EXPECT_THAT(warnings(check_loss(view_)), IsEmpty());
  EXPECT_THAT(fine(), ElementsAre(HasSubstr("dyncal-dau:3 on lab-4: not measured, for it answers "
                                            "no probes"),
                                  HasSubstr("not measured, for only 12 probes were sent")));
}

} // namespace
} // namespace dyncal::inline checks::doctor
