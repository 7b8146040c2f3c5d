// Decisions as a table for the terminal. Any thread.
#pragma once

#include <string>

#include "services/views/conformity/conformity.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string conformity_table(const ConformityReport& report);

} // namespace dyncal::inline views
