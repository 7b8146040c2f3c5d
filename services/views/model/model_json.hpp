// Models and filters as JSON for programs, with every digit. model.schema.json describes each key.
//
// Filters have the names and the order that PyDynamic's FIRuncFilter and IIRuncFilter take: b, a
// (a[0] = 1), Ub of b, Uab of (a[1:], b). What is not known is null. Plain function, any thread.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "services/views/model/channel_model.hpp"

namespace dyncal::inline views {

// Raised with every change of the schema; keys are added, never renamed.
inline constexpr int model_schema_version = 1;

[[nodiscard]] nlohmann::ordered_json model_json(const std::vector<std::string>& files,
                                                const std::vector<ChannelModel>& models);

} // namespace dyncal::inline views
