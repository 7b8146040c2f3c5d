// What a run leaves behind: a table for people, JSON for programs.
//
// Phase is lead, in rad, within (-pi, pi] (a delay is negative); `u_` is a standard uncertainty (k
// = 1). Plain functions, any thread.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "services/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::services {

// The channel's magnitude is above three times its uncertainty at more than half of the
// frequencies: it is worth showing.
[[nodiscard]] bool responds(const TransferFunction& function);

// One row per channel and frequency; channels that do not respond are only named.
[[nodiscard]] std::string result_table(const RunOutcome& outcome);

[[nodiscard]] nlohmann::ordered_json result_json(const RunOutcome& outcome);

// Fails (bad_file) when the file cannot be written.
[[nodiscard]] Expected<void> write_json(const std::filesystem::path& path,
                                        const nlohmann::ordered_json& json);

} // namespace dyncal::services
