// Which DDS implementation each service of a demo uses: "cyclonedds" for all, or
// "dau=cyclonedds,acs=fastdds,analysis=cyclonedds". Services that are not named use the first
// implementation of the build. Plain data; any thread.
#pragma once

#include <map>
#include <string>

#include "services/base/error.hpp"

namespace dyncal::inline programs {

// The implementation for each of "dau", "acs", "analysis" and "run". Fails (bad_argument) for other
// names.
[[nodiscard]] Expected<std::map<std::string, std::string>>
parse_vendor_assignment(const std::string& text);

} // namespace dyncal::inline programs
