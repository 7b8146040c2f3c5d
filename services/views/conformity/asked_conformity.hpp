// The decisions that were asked for: by a tolerance file, or by what the sensor file has. Any
// thread.
#pragma once

#include <filesystem>
#include <optional>

#include "services/base/error.hpp"
#include "services/views/conformity/conformity.hpp"

namespace dyncal::inline views {

// Nothing: neither has tolerances; the file stands before the sensor's. Fails (bad_file) as
// read_tolerance_file() does, and (bad_argument) for a channel without a value.
[[nodiscard]] Expected<std::optional<ConformityReport>>
asked_conformity(const StoredResult& result, const std::vector<std::string>& channels,
                 const std::filesystem::path& tolerance_file,
                 const std::optional<Tolerances>& of_sensor);

} // namespace dyncal::inline views
