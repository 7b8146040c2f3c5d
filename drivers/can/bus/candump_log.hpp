// A recorded log of CAN frames in the format of can-utils' `candump -l`: "(seconds.microseconds)
// interface id#data", FD as id##FDATA with one hex digit of flags, remote frames as id#R. The
// stamps of the log become the frames' kernel stamps. Plain function, any thread. Fails with file
// and line at the first line that is no frame.
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
