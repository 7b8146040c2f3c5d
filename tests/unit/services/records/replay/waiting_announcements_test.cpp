// When what a conductor said counts in the walk through a recording.
#include "services/records/replay/waiting_announcements.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace dyncal::inline records {
namespace {

class WaitingAnnouncementsTest : public testing::Test {
protected:
  WaitingAnnouncements announcements_;

  void SetUp() override {
    announcements_.wait_for("acs");
    announcements_.wait_for("dau");
    announcements_.add({.place = 10, .time_ns = 1000}, StepAnnouncement{.step = 1});
  }
  [[nodiscard]] std::vector<WaitingAnnouncements::Announcement> given(bool at_once = false) {
    std::vector<WaitingAnnouncements::Announcement> all;
    announcements_.hand_over(at_once, [&](const auto& one, std::int64_t recorded_ns) {
      EXPECT_GE(recorded_ns, 1000);
      all.push_back(one);
    });
    return all;
  }
  [[nodiscard]] bool counts() { return given().size() == 1; }
};

TEST_F(WaitingAnnouncementsTest, CountWhenEverySourceHasSentSomethingBehindThem) {
  announcements_.reach("acs", 11, 1001, false);
  EXPECT_FALSE(counts());
  announcements_.reach("dau", 9, 1002, false); // a clock that runs ahead tells nothing
  EXPECT_FALSE(counts());
  announcements_.reach("dau", 12, 1003, false);
  EXPECT_TRUE(counts());
  EXPECT_FALSE(counts());
}

TEST_F(WaitingAnnouncementsTest, WaitForWhatIsGivenAgainBehindThem) {
  announcements_.reach("acs", 11, 1001, false);
  announcements_.reach("dau", 12, 400, false);
  announcements_.reach("dau", 13, 999, false);
  EXPECT_FALSE(counts());
  announcements_.reach("dau", 14, 1000, false);
  EXPECT_TRUE(counts());
}

TEST_F(WaitingAnnouncementsTest, WaitForNoSourceThatHasEnded) {
  announcements_.reach("acs", 11, 1001, false);
  announcements_.reach("dau", 5, 400, true);
  EXPECT_TRUE(counts());
}

TEST_F(WaitingAnnouncementsTest, WaitForASourceThatBeganAgain) {
  announcements_.reach("acs", 11, 1001, false);
  announcements_.reach("dau", 5, 400, true);
  announcements_.reach("dau", 6, 500, false);
  EXPECT_FALSE(counts());
}

TEST_F(WaitingAnnouncementsTest, ComeInTheirOrderAndAllAtTheEnd) {
  announcements_.add({.place = 20, .time_ns = 2000}, wire::MEASUREMENT_DONE);
  announcements_.reach("acs", 21, 1500, false);
  announcements_.reach("dau", 22, 1500, false);
  const auto step = given();
  ASSERT_EQ(step.size(), 1U);
  EXPECT_EQ(std::get<StepAnnouncement>(step.front()).step, 1U);
  const auto end = given(true);
  ASSERT_EQ(end.size(), 1U);
  EXPECT_EQ(std::get<wire::MeasurementState>(end.front()), wire::MEASUREMENT_DONE);
  EXPECT_TRUE(given(true).empty());
}

} // namespace
} // namespace dyncal::inline records
