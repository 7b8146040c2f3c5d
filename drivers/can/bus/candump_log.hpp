// A recorded log of CAN frames as can-utils writes it, by `candump -l` or, with absolute stamps, on
// the screen (`candump -ta`):
//
//   (seconds.microseconds) interface id#data
//   (seconds.microseconds)  interface  id   [length]  da ta ...
//
// FD frames are id##FDATA with one hex digit of flags F, remote frames id#R. The stamps of the log
// become the frames' kernel stamps. A line whose stamp lies before that of the line above it, but
// not the line below it, was written late: it is put where it belongs, up to 64 lines back. Error
// frames are passed over, and so are lines that are none of these, up to 1 % of all and a last one
// that is cut off; `passed_over` counts the latter.
//
// Fails: not_found when the file cannot be read; malformed, with file and line, when more lines
// than that are no frames. Pure function; any thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/can/bus/can_frame.hpp"
#include "drivers/error.hpp"

namespace dyncal::drivers::can {

struct CandumpLog {
  std::vector<CanFrame> frames;
  std::size_t passed_over = 0;       // lines
  std::size_t first_passed_over = 0; // number of the first of them, from 1
};

// Frames of `interface_name` only; of all when it is empty.
[[nodiscard]] Expected<CandumpLog> read_candump_log(const std::filesystem::path& path,
                                                    const std::string& interface_name);

} // namespace dyncal::drivers::can
