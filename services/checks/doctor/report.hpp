// Findings for people and for programs that watch. Plain functions, any thread.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "services/base/finding.hpp"
#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {

// One line a finding, in their order, and a last line with what came of all.
[[nodiscard]] std::string as_text(const Findings& findings);

// "status", "findings", and what was observed: "programs", "clocks", "losses", "sources",
// "participants".
[[nodiscard]] nlohmann::ordered_json as_json(const Findings& findings, const LaboratoryView& view);

} // namespace dyncal::inline checks::doctor
