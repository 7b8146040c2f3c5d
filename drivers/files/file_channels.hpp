// The description of a source that is a file: its channels with the names and units that the
// settings give them.
#pragma once

#include <string>
#include <vector>

#include "drivers/files/file_source.hpp"

namespace dyncal::drivers::files {

// `texts` are names as the file has them, with the unit in brackets behind a blank or without.
// Fails (not_found) when the settings name a channel that the file has not.
[[nodiscard]] Expected<SourceDescription>
describe_file_channels(const FileSettings& settings, const std::vector<std::string>& texts);

} // namespace dyncal::drivers::files
