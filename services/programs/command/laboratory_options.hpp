// The commands that look at what is on the network, with their options and help: watch, list and
// doctor.
// Belongs to the main thread.
#pragma once

#include <optional>
#include <stop_token>

#include "services/programs/command/doctor_command.hpp"
#include "services/programs/command/list_command.hpp"
#include "services/programs/command/watch_command.hpp"

namespace dyncal::inline programs {

struct LaboratoryCommands {
  WatchCommand watch;
  ListCommand list;
  DoctorCommand doctor;
};

void add_laboratory(CLI::App& app, LaboratoryCommands& commands);

// The exit status of the one that was chosen; nothing when none was.
[[nodiscard]] std::optional<int> run_laboratory_command(const CLI::App& app,
                                                        const LaboratoryCommands& commands,
                                                        const std::stop_token& stop);

} // namespace dyncal::inline programs
