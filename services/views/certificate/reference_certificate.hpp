// A reference file (services/bench/file/reference_file.hpp) made from the digital calibration
// certificate of a transducer: its identity, its values as they are printed there, and what a
// person has to add, which is what the certificate cannot know.
//
// Fails (bad_file): no DCC, no table of a response or several of them and none named, a unit that
// is not that of a sensitivity. One thread at a time.
#pragma once

#include <filesystem>
#include <string>

#include "services/base/error.hpp"

namespace dyncal::inline views {

// `table`: the name of one of several tables; empty: the only one.
[[nodiscard]] Expected<std::string> reference_file_of(const std::filesystem::path& certificate,
                                                      const std::string& table);

} // namespace dyncal::inline views
