// `dyncal doctor`: who is on the network, what does not fit together, and what to do about it
// (services/checks/doctor). Works where nothing is on the network, too.
//
// The exit status is for monitoring: 0 nothing is wrong, 1 warnings, 2 problems, 3 it could not
// look. Belongs to one thread.
#pragma once

#include <stop_token>
#include <string>

#include "services/daemon/program/program.hpp"

namespace dyncal::inline programs {

struct DoctorCommand {
  std::string bench_file; // empty: none to compare with
  double seconds = 5.0;
  bool json = false;
  NetworkOptions network;
};

// Returns only when there is nothing to report: options, bench file or network cannot be used. Else
// it ends the process.
[[nodiscard]] int run_doctor(const DoctorCommand& command, const std::stop_token& stop);

} // namespace dyncal::inline programs
