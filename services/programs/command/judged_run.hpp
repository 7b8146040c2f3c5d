// A run that is held against tolerances (services/views/conformity), and what is left of that in
// its folder, where the page shows it. One thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/views/conformity/conformity.hpp"

namespace dyncal::inline programs {

struct JudgedRun {
  StoredResult result;
  ConformityReport report;
};

// By a tolerance file, else by what the sensor has. `channels`: empty: all that respond. Fails
// (bad_argument) where there are no tolerances.
[[nodiscard]] Expected<JudgedRun> judge_run(StoredResult result,
                                            const std::vector<std::string>& channels,
                                            const std::filesystem::path& tolerance_file,
                                            const std::optional<Tolerances>& of_sensor);

// conformity.json in the folder of the run, NAME-conformity.json beside NAME.json; returns it.
[[nodiscard]] Expected<std::filesystem::path> keep_conformity(const std::filesystem::path& run,
                                                              const JudgedRun& judged);

} // namespace dyncal::inline programs
