// Files that programs write for people and for other programs: whole, or not at all.
//
// The text goes to a file beside, NAME.part, reaches the disk, and only then takes the name, which
// is on the disk as well when the function returns. A full
// disk or a kill leaves an older file of that name as it was, and a reader that polls for the name
// never sees a part. What is not a regular file (/dev/stdout, a pipe) is written as it is.
//
// Fails (bad_file) with the file, the reason and what to do. Any thread; two programs that write
// one name at the same time are not kept apart.
#pragma once

#include <filesystem>
#include <string_view>

#include "services/base/error.hpp"

namespace dyncal::inline base {

[[nodiscard]] Expected<void> write_output_file(const std::filesystem::path& path,
                                               std::string_view text);

// The same, never in place of another file of this name.
[[nodiscard]] Expected<void> write_new_file(const std::filesystem::path& path,
                                            std::string_view text);

// Whether a file of this name could be written now: to be asked before hours of measurement rather
// than after. Leaves nothing behind, and an older file as it is.
[[nodiscard]] Expected<void> check_output_file(const std::filesystem::path& path);

// And whether there is none of this name yet.
[[nodiscard]] Expected<void> check_new_file(const std::filesystem::path& path);

// The same for files in a folder, which is made if it is not there.
[[nodiscard]] Expected<void> check_output_folder(const std::filesystem::path& folder);

} // namespace dyncal::inline base
