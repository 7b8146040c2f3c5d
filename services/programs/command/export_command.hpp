// `dyncal export SOURCE --to TARGET`: a recording in a format of other programs
// (services/records/exchange/export_recording.hpp). Belongs to one thread.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

namespace dyncal::inline programs {

struct ExportCommand {
  std::filesystem::path recording; // or run folder, or HDF5 export
  std::filesystem::path to;
  std::string format; // empty: by the name of the target
  std::vector<std::string> channels;
};

[[nodiscard]] int run_export(const ExportCommand& command, const std::stop_token& stop);

} // namespace dyncal::inline programs
