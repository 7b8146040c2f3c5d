// The file that a recording gets: FOLDER/BENCH/NAME.mcap, in letters that every file system takes.
// Plain function, any thread.
#pragma once

#include <filesystem>
#include <string>

namespace dyncal::inline programs {

// One that is not there yet: "-2" and so on where the name is taken. Other characters than letters,
// digits and ". _ - +" become "_", as does a dot at the beginning.
[[nodiscard]] std::filesystem::path recording_name(const std::filesystem::path& folder,
                                                   const std::string& bench,
                                                   const std::string& name);

} // namespace dyncal::inline programs
