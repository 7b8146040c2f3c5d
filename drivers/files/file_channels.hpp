// The description of a source that is a file: its channels with the names and units that the
// settings give them.
#pragma once

#include <string>
#include <vector>

#include "drivers/files/file_source.hpp"

namespace dyncal::drivers::files {

// `names` are those of the file. Fails (not_found) when the settings name a channel that the file
// has not.
[[nodiscard]] Expected<SourceDescription>
describe_file_channels(const FileSettings& settings, const std::vector<std::string>& names);

} // namespace dyncal::drivers::files
