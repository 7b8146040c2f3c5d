// Whether sources whose stamps are compared with each other are meant to be of one time scale.
// Plain functions, any thread.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "idl/dyncal.h"
#include "services/error.hpp"
#include "services/evaluation/recipe.hpp"

namespace dyncal::services {

// `time_base_of` a source: empty as long as it has not described itself. Fails (no_source) with the
// sources that disagree.
[[nodiscard]] Expected<void> check_time_scales(
    const Recipe& recipe,
    const std::function<std::optional<wire::TimeBase>(const std::string&)>& time_base_of);

} // namespace dyncal::services
