#include "services/views/report/daily_check.hpp"

#include <fmt/core.h>

namespace dyncal::inline views {

std::string sentence_of(const DailyCheck& check) {
  if (!check.left_out.empty()) {
    return fmt::format("The daily check of the bench with sensor {} was left out: {}", check.sensor,
                       check.left_out);
  }
  if (check.run.empty()) {
    return fmt::format("This run is of the check sensor of the bench, {}", check.sensor);
  }
  return fmt::format("Daily check of the bench with sensor {}, run {} of {}: {}", check.sensor,
                     check.run, check.began_utc, check.state);
}

} // namespace dyncal::inline views
