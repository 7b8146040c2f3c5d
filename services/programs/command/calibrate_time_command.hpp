// `dyncal calibrate time`: how far a DAU's time stamps are from a reference pulse per second (paper
// section 2.2, figure 2; the model is that of analysis/instrument/stamp_deviation.hpp), from the
// unit's own record of both pulses (services/programs/command/pulse_file.hpp).
//
// Prints which edges were rejected and why, and the deviation; writes OUTPUT.json and beside it
// OUTPUT.svg and OUTPUT.csv. A record of the GPS pulse alone has no deviation: it is judged by how
// well its pulses can be foretold from the ones before, and the status is that of success. Belongs
// to one thread.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace dyncal::inline programs {

struct CalibrateTimeCommand {
  std::vector<std::filesystem::path> files;
  std::filesystem::path output = "time-calibration.json";
  std::optional<double>
      reference_offset_s; // of the reference pulse after the GPS second, at the unit
  double u_reference_s = 0.0;
};

[[nodiscard]] int run_calibrate_time(const CalibrateTimeCommand& command);

} // namespace dyncal::inline programs
