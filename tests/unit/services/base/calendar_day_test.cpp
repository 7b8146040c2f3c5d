#include "services/base/calendar_day.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline base {
namespace {

TEST(CalendarDay, MonthsLaterIsTheSameDayOrTheLastOfAMonth) {
  EXPECT_EQ(months_after("2026-02-20", 12), "2027-02-20");
  EXPECT_EQ(months_after("2026-08-31", 6), "2027-02-28");
  EXPECT_EQ(months_after("2027-08-31", 6), "2028-02-29");
  EXPECT_EQ(months_after("2026-11-15", 2), "2027-01-15");
}

TEST(CalendarDay, DaysGoOverMonthsAndYears) {
  EXPECT_EQ(days_after("2026-11-27", 30), "2026-12-27");
  EXPECT_EQ(days_after("2027-12-31", 1), "2028-01-01");
  EXPECT_EQ(days_after("2026-11-27", 0), "2026-11-27");
}

TEST(CalendarDay, TodayIsADay) {
  const std::string today = today_utc();
  ASSERT_EQ(today.size(), 10U);
  EXPECT_EQ(days_after(today, 0), today);
  EXPECT_GT(today, "2026-01-01");
}

} // namespace
} // namespace dyncal::inline base
