// Makes a recording that ended in order of one that did not, or that was damaged: every sound
// message, attachment and metadata goes into a new file; the old one stays as it is.
//
// What could not be read stands in the new file, too: as metadata "dyncal.repair". The new file is
// NAME.part until all of it is there, so that nobody takes a part of it for the whole. Fails
// (bad_file) as reader and writer do, and when a file of the new name is there. Plain function, any
// thread.
#pragma once

#include <filesystem>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records::recording {

// Returns what was found in the old file. `count`: of its megabytes, read and then copied.
[[nodiscard]] base::Expected<ScanReport> repair(const std::filesystem::path& path,
                                                const std::filesystem::path& repaired,
                                                const std::string& library,
                                                const base::SharedWorkCount& count = nullptr);

} // namespace dyncal::inline records::recording
