// `dyncal watch`: what the bus shows now (services/network), again and again.
//
// On a terminal a table that is redrawn once a second and stays within the window
// (laboratory_table.hpp); elsewhere every change is a line (laboratory_lines.hpp), or with --json
// the whole state is a line of JSON each time that it has changed. Colours are for terminals, and
// off where NO_COLOR is set. It asks every program for its clock, and publishes nothing else.
// Belongs to one thread.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "services/daemon/program/program.hpp"

namespace dyncal::inline programs {

struct WatchCommand {
  std::string bench = "*";
  std::optional<double> seconds;
  bool all = false;
  bool flags = false; // each with what it means
  bool json = false;
  NetworkOptions network;
};

[[nodiscard]] int run_watch(const WatchCommand& command, const std::stop_token& stop);

} // namespace dyncal::inline programs
