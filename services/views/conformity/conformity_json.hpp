// Decisions as JSON: what `dyncal conformity --json` prints, and conformity.json of a run folder.
// Numbers have all digits; null: not known. Any thread.
#pragma once

#include <nlohmann/json.hpp>

#include "services/views/conformity/conformity.hpp"

namespace dyncal::inline views {

[[nodiscard]] nlohmann::ordered_json conformity_json(const ConformityReport& report,
                                                     const StoredResult& result);

} // namespace dyncal::inline views
