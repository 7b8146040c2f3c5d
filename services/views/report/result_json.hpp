// What a run leaves behind, as JSON for programs: the whole record of a calibration in one file,
// with every digit. result.schema.json describes each key; its version stands in "schema".
//
// Phase is lead, in rad and degrees, within (-pi, pi] (a delay is negative); u_ is a standard
// uncertainty (k = 1), U_ = k u_ the expanded one at 95.45 %. What is not known, not a number or
// infinite is null. Plain functions, any thread.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// A mean as its file has it, without flags.
[[nodiscard]] StoredValue value_of(const TransferFunction& function, const FrequencyPoint& point);

// As its file has it.
[[nodiscard]] StoredResult stored_result_of(const RunOutcome& outcome);

[[nodiscard]] nlohmann::ordered_json result_json(const StoredResult& result);
[[nodiscard]] nlohmann::ordered_json result_json(const RunOutcome& outcome,
                                                 const RunStatements& stated = {});

// Fails (bad_file) when the file cannot be written.
[[nodiscard]] Expected<void> write_json(const std::filesystem::path& path,
                                        const nlohmann::ordered_json& json);

} // namespace dyncal::inline views
