// A file that must be new: whole, or not at all, and never in place of another. Fails (bad_file)
// when there is one of this name, or with why it cannot be written. Any thread, any number of
// programs.
#pragma once

#include <filesystem>
#include <string_view>

#include "services/base/error.hpp"

namespace dyncal::inline bench::bench_draft {

// Whether there is none of this name, and one could be written.
[[nodiscard]] Expected<void> check_new_file(const std::filesystem::path& path);

[[nodiscard]] Expected<void> write_new_file(const std::filesystem::path& path,
                                            std::string_view text);

} // namespace dyncal::inline bench::bench_draft
