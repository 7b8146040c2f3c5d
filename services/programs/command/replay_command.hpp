// `dyncal replay RECORDING`: puts a recording back on DDS
// (services/records/replay/recording_player.hpp). Belongs to one thread.
#pragma once

#include <stop_token>
#include <string>

#include "services/daemon/program/program.hpp"
#include "services/records/replay/recording_player.hpp"

namespace dyncal::inline programs {

struct ReplayCommand {
  ReplayOptions wish;
  std::string speed = "1"; // multiple of real time, or "max"
  bool without_results = false;
  NetworkOptions network;
};

[[nodiscard]] int run_replay(const ReplayCommand& command, const std::stop_token& stop);

} // namespace dyncal::inline programs
