// Results of which each is of an excitation along one axis of a sensor with three, and the names of
// its channels. Plain functions, any thread.
#pragma once

#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include "services/base/byte_count.hpp"
#include "services/base/error.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline programs {

inline constexpr std::string_view axis_names = "xyz";
using AxisChannels = std::array<std::string, 3>;

// The names that end with "_x", "_y", "_z" after the same beginning, when there is one such
// beginning; else the sentence names `option`.
[[nodiscard]] Expected<AxisChannels> find_channels(const std::set<std::string>& names,
                                                   const std::string& option);

// Points without the excited axis, which is `along`; a file that states another is refused.
[[nodiscard]] Expected<ResultPoints> read_points(const std::filesystem::path& path, char along,
                                                 ByteCount& bytes);

} // namespace dyncal::inline programs
