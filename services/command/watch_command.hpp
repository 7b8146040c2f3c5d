// `dyncal watch`: benches, sources with their rates and losses, runs, results with their flags, and
// how far the clocks of other hosts are from this one, as they come on the network.
//
// On a terminal the screen is redrawn once a second, with an explanation of every flag below;
// elsewhere every change is a line, and so is the explanation of a flag when it first occurs. It
// asks every program for its clock, and publishes nothing else. Belongs to one thread.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "services/program/program.hpp"

namespace dyncal::services {

struct WatchCommand {
  std::string bench = "*";
  std::optional<double> seconds;
  NetworkOptions network;
};

[[nodiscard]] int run_watch(const WatchCommand& command, const std::stop_token& stop);

} // namespace dyncal::services
