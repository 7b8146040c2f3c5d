// `dyncal list`: benches with their sources and runs that are on the network now, once. It listens
// until nothing new has come for a second, for `seconds` at most. Belongs to one thread.
#pragma once

#include <stop_token>
#include <string>

#include "services/daemon/program/program.hpp"

namespace dyncal::inline programs {

struct ListCommand {
  std::string bench = "*";
  double seconds = 5.0;
  bool json = false;
  NetworkOptions network;
};

[[nodiscard]] int run_list(const ListCommand& command, const std::stop_token& stop);

} // namespace dyncal::inline programs
