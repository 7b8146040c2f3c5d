#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/doctor/checks.hpp"
#include "tests/unit/services/doctor/findings.hpp"

namespace dyncal::services::doctor {
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
  void add(const Way& there, const Way& back, const std::string& host = "lab-2") {
    view_.losses.push_back({.identity = {"dyncal-acs", host, 3, "", ""},
                            .answers_probes = true,
                            .there = there,
                            .back = back});
  }
  [[nodiscard]] std::vector<std::string> fine() const {
    return sentences(check_loss(view_), Severity::ok);
  }

  LaboratoryView view_;
};

TEST_F(CheckLoss, StatesBothDirectionsOfEveryProgram) {
  add({200, 200}, {200, 198});
  add({180, 179}, {179, 179}, "lab-3");
  EXPECT_THAT(warnings(check_loss(view_)), IsEmpty()) << "1 % is not more than 1 %";
  EXPECT_THAT(fine(), ElementsAre("loss: dyncal-acs:3 on lab-2: probes there 0.0 % of 200 lost, "
                                  "echoes back 1.0 % of 200 lost",
                                  "loss: dyncal-acs:3 on lab-3: probes there 0.6 % of 180 lost, "
                                  "echoes back 0.0 % of 179 lost"));
}

TEST_F(CheckLoss, WarnsOfLossThereAndSaysWhereToLook) {
  add({200, 180}, {180, 180});
  EXPECT_THAT(warnings(check_loss(view_)),
              ElementsAre(AllOf(HasSubstr("there 10.0 % of 200 lost, echoes back 0.0 % of 180"),
                                HasSubstr("switch ports"), HasSubstr("tc -s qdisc"),
                                HasSubstr("found no room on lab-2 (`nstat"))));
}

TEST_F(CheckLoss, WarnsOfLossOnTheWayBackAndSaysWhereToLook) {
  add({200, 200}, {200, 197});
  EXPECT_THAT(warnings(check_loss(view_)),
              ElementsAre(AllOf(HasSubstr("back 1.5 % of 200 lost"),
                                HasSubstr("found no room on lab-1 (`nstat"))));
}

TEST_F(CheckLoss, WarnsOfLossWithinTheHostWithoutCables) {
  add({200, 100}, {100, 50}, "lab-1");
  EXPECT_THAT(warnings(check_loss(view_)),
              ElementsAre(AllOf(HasSubstr("no room on both hosts"), Not(HasSubstr("cable")))));
}

TEST_F(CheckLoss, TellsThatNothingGetsThroughAlthoughAnswersDo) {
  add({200, 0}, {0, 0});
  add({200, 200}, {200, 0}, "lab-3");
  EXPECT_THAT(warnings(check_loss(view_)),
              ElementsAre(AllOf(HasSubstr("there 100.0 % of 200 lost, echoes back not measured"),
                                HasSubstr("none gets through, although")),
                          AllOf(HasSubstr("back 100.0 % of 200 lost"),
                                HasSubstr("none gets through, although"))));
}

TEST_F(CheckLoss, TellsWhereNothingCouldBeMeasured) {
  EXPECT_THAT(fine(), ElementsAre(HasSubstr("not measured: no service answers")));
  view_.losses = {{.identity = {"dyncal-dau", "lab-4", 3, "", ""}}};
  add({12, 0}, {0, 0});
  EXPECT_THAT(warnings(check_loss(view_)), IsEmpty());
  EXPECT_THAT(fine(), ElementsAre(HasSubstr("dyncal-dau:3 on lab-4: not measured, for it answers "
                                            "no probes"),
                                  HasSubstr("not measured, for only 12 probes were sent")));
}

} // namespace
} // namespace dyncal::services::doctor
