// `dyncal history SENSOR`: the drift of a sensor over its calibrations in the store
// (services/records/store/history.hpp), as tables, JSON and figures. Belongs to one thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "services/programs/command/store_command.hpp"

namespace dyncal::inline programs {

struct HistoryCommand {
  StoreOptions store;
  std::string sensor;
  std::string channel;                // empty: all
  std::optional<double> frequency_hz; // nothing: all
  std::optional<std::filesystem::path> figures;
  bool json = false;
};

// Returns the exit status.
[[nodiscard]] int run_history(const HistoryCommand& command);

} // namespace dyncal::inline programs
