// A recorded log of CAN frames in the format of can-utils' `candump -l`:
//
//   (seconds.microseconds) interface id#data
//
// FD frames are id##FDATA with one hex digit of flags F, remote frames id#R. The stamps of the log
// become the frames' kernel stamps.
//
// Fails: not_found when the file cannot be read; malformed, with file and line, at the first line
// that is not a frame. Pure function; any thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/error.hpp"

namespace dyncal::drivers::can {

// Frames of `interface_name` only; of all when it is empty.
[[nodiscard]] Expected<std::vector<BusEvent>> read_candump_log(const std::filesystem::path& path,
                                                               const std::string& interface_name);

} // namespace dyncal::drivers::can
