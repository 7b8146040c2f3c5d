#include "services/evaluation/method/time_scales.hpp"

#include <vector>

#include <fmt/format.h>

namespace dyncal::services {

Expected<void> check_time_scales(
    const Recipe& recipe,
    const std::function<std::optional<wire::TimeBase>(const std::string&)>& time_base_of) {
  if (!recipe.stamped_apart()) {
    return {};
  }
  const bool by_absolute_time = recipe.method == wire::METHOD_ABSOLUTE_TIME;
  const std::string& link = by_absolute_time ? recipe.reference.source : recipe.sync_dau.source;
  std::vector<std::string> names = recipe.dut_sources();
  names.push_back(link);
  for (const std::string& name : names) {
    const auto clock = time_base_of(name);
    const auto clock_of_link = time_base_of(link);
    if (by_absolute_time && clock == wire::TIME_BASE_LOCAL) {
      return fail(
          ErrorCode::no_source,
          fmt::format("source '{}' has a clock of its own, but absolute time needs all clocks on "
                      "UTC; set it to UTC and say time_base = \"utc\", or use a sync signal",
                      name));
    }
    if (clock && clock_of_link && *clock != *clock_of_link) {
      return fail(
          ErrorCode::no_source,
          fmt::format("sources '{}' and '{}' must be stamped on one time scale, but one is in UTC "
                      "and the other has a clock of its own",
                      name, link));
    }
  }
  return {};
}

} // namespace dyncal::services
