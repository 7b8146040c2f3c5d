#include "services/base/calendar_day.hpp"

#include <chrono>
#include <sstream>

#include <fmt/format.h>

namespace dyncal::inline base {
namespace {

using std::chrono::year_month_day;

year_month_day parsed(const std::string& day) {
  std::istringstream stream(day);
  int year = 0;
  unsigned month = 0;
  unsigned number = 0;
  char dash = 0;
  stream >> year >> dash >> month >> dash >> number;
  return {std::chrono::year(year), std::chrono::month(month), std::chrono::day(number)};
}

std::string text_of(const year_month_day& day) {
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(day.year()),
                     static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day()));
}

} // namespace

std::string months_after(const std::string& day, int months) {
  year_month_day later = parsed(day) + std::chrono::months(months);
  if (!later.ok()) {
    later = later.year() / later.month() / std::chrono::last;
  }
  return text_of(later);
}

std::string days_after(const std::string& day, int days) {
  return text_of(year_month_day(std::chrono::sys_days(parsed(day)) + std::chrono::days(days)));
}

std::string today_utc() {
  return text_of(
      year_month_day(std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now())));
}

} // namespace dyncal::inline base
