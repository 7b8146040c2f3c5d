// `dyncal triaxial --x X.json --y Y.json --z Z.json`: the response of a sensor's three axes from
// one result for each direction of excitation, and its transverse sensitivity
// (analysis/response/triaxial.hpp).
//
// The result of an excitation along j holds the transfer functions of the sensor's three channels
// against the reference along j: column j of the 3x3 response. Any one direction is enough for its
// column; transverse motion is then assumed to be zero, and its bound (--transverse-motion) goes
// into the uncertainty. With a triaxial reference the transverse motion is known: --motion-x, -y,
// -z name a result each (method analogue) of the other two axes of the reference against the
// excited one, from the same records; they need all three directions. Frequencies are those that
// all files have. A channel is found by the end of its name (_x, _y, _z) or named with --channels,
// --motion-channels.
//
// Prints a table, or JSON. Exit status not 0 and one line when a file is not a result, a channel is
// missing or nothing is in common. Belongs to one thread.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace dyncal::inline programs {

struct TriaxialCommand {
  std::array<std::filesystem::path, 3> results; // by direction of excitation; empty: not measured
  std::array<std::filesystem::path, 3>
      motions;                              // of a triaxial reference; empty: single-axis reference
  std::vector<std::string> channels;        // of the sensor: x, y, z; empty: found
  std::vector<std::string> motion_channels; // of the reference: x, y, z; empty: found
  double transverse_motion_rel = 0.0;       // bound of the motion across a single-axis reference
  bool json = false;
};

[[nodiscard]] int run_triaxial(const TriaxialCommand& command);

} // namespace dyncal::inline programs
