// Days of the calendar as texts, YYYY-MM-DD, so that the later one is the greater text. Plain
// functions; any thread.
#pragma once

#include <string>

namespace dyncal::inline base {

// That many months after a day that there is; the last of a month that is too short.
[[nodiscard]] std::string months_after(const std::string& day, int months);
[[nodiscard]] std::string days_after(const std::string& day, int days);
// In UTC.
[[nodiscard]] std::string today_utc();

} // namespace dyncal::inline base
