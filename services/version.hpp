// The software that made a result, as results and descriptions carry it: "dyncal 0.1.0 (commit)".
#pragma once

#include <string>

namespace dyncal::services {

[[nodiscard]] std::string software_version();

} // namespace dyncal::services
