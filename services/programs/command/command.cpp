#include "services/programs/command/command.hpp"

#include <map>
#include <utility>

namespace dyncal::inline programs {
namespace {

struct Registered {
  std::string description;
  std::function<Command::Action(CLI::App&)> add;
};

// By place, then name, so that none hides another of its place.
using Place = std::pair<int, std::string>;

std::map<Place, Registered>& registered_commands() { // made by the first that registers itself
  static std::map<Place, Registered> commands;
  return commands;
}

} // namespace

Command::Command(int place, std::string name, std::string description,
                 std::function<Action(CLI::App&)> add) {
  registered_commands()[{place, std::move(name)}] = {std::move(description), std::move(add)};
}

void add_commands(CLI::App& app, Command::Action& chosen) {
  for (const auto& [place, command] : registered_commands()) {
    const std::string& name = place.second;
    const auto blank = name.find(' ');
    const bool is_below = blank != std::string::npos;
    CLI::App& parent = is_below ? *app.get_subcommand(name.substr(0, blank)) : app;
    CLI::App* added =
        parent.add_subcommand(is_below ? name.substr(blank + 1) : name, command.description);
    if (command.add) {
      added->callback([&chosen, action = command.add(*added)] { chosen = action; });
    } else {
      added->require_subcommand(1);
    }
  }
}

} // namespace dyncal::inline programs
