// Opens a recorded series by its format, which the ending of its name tells. README.md has them.
#pragma once

#include <memory>

#include "drivers/files/file_source.hpp"

namespace dyncal::drivers::files {

// The whole file `settings.path`, or of TDMS the one channel that `settings.channel` names. Fails
// as FileSource does.
[[nodiscard]] Expected<std::unique_ptr<SampleReader>> open_file(const FileSettings& settings);

} // namespace dyncal::drivers::files
