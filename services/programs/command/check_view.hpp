// A control chart (services/records/store/control_chart.hpp) as `dyncal history --check` shows it:
// table, JSON and figures. Belongs to one thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "services/base/error.hpp"
#include "services/records/store/control_chart.hpp"
#include "services/records/store/history.hpp"

namespace dyncal::inline programs {

struct CheckView {
  std::string sensor;
  ControlChart chart;
  History history; // of the chart's calibrations, for E_n against the one before
};

[[nodiscard]] std::string check_table(const CheckView& view);
[[nodiscard]] nlohmann::ordered_json check_json(const CheckView& view);
// A figure a channel; returns the paths of what was written.
[[nodiscard]] Expected<std::vector<std::filesystem::path>>
write_check(const CheckView& view, const std::filesystem::path& folder);

// Of a check: 0 in control, 5 warning, 3 action, 4 too few results.
[[nodiscard]] int exit_status_of(CheckState state);

} // namespace dyncal::inline programs
