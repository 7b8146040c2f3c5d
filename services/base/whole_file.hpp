// A file that is read whole into memory, and never more of it than such a file may have.
//
// Fails (bad_file) with its name and the reason: a folder, no such file, not readable, or more than
// `max_bytes`. Plain function, any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "services/base/error.hpp"

namespace dyncal::inline base {

[[nodiscard]] Expected<std::string> read_whole_file(const std::filesystem::path& path,
                                                    std::uintmax_t max_bytes);

} // namespace dyncal::inline base
