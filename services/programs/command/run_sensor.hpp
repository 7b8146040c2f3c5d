// The sensor that a run names, by its serial number in the library (--sensor, or the key `sensor`
// of its bench file): it must be there before anything is excited, and afterwards the run says
// whether it meets the tolerances of the sensor. One thread.
#pragma once

#include <filesystem>
#include <string>

#include "services/base/error.hpp"
#include "services/programs/command/keep_options.hpp"

namespace dyncal::inline programs {

// `serial` empty, or no store: nothing to be done. Fails (bad_argument) for one that is not there.
[[nodiscard]] Expected<void> require_sensor(const std::string& serial, const KeepOptions& keep);

// Prints the decisions and keeps them in the folder of the run, for the page.
[[nodiscard]] Expected<void> show_conformity(const std::string& serial, const KeepOptions& keep,
                                             const std::filesystem::path& folder);

} // namespace dyncal::inline programs
