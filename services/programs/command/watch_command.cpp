// `dyncal watch`: what the bus shows now (services/network), again and again.
//
// On a terminal a table that is redrawn once a second and stays within the window
// (laboratory_table.hpp); elsewhere every change is a line (laboratory_lines.hpp), or with --json
// the whole state is a line of JSON each time that it has changed. Colours are for terminals, and
// off where NO_COLOR is set. It asks every program for its clock, and publishes nothing else.
// Belongs to one thread.
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/laboratory_lines.hpp"
#include "services/programs/command/laboratory_table.hpp"
#include "services/programs/command/watched_laboratory.hpp"
#include "services/views/live/laboratory_json.hpp"

namespace dyncal::inline programs {
namespace {

struct WatchOptions {
  std::string bench = "*";
  std::optional<double> seconds;
  TableLayout table;
  bool json = false;
  NetworkOptions network;
};

void add_watch(CLI::App& command, WatchOptions& watch) {
  command.add_option("--bench", watch.bench, "only this bench (default: all)");
  add_checked(command, "--seconds", watch.seconds, "end after this time (default: until Ctrl-C)",
              CLI::PositiveNumber);
  command.add_flag("--all", watch.table.all,
                   "also runs that are over, channels that do not respond, benches that are gone, "
                   "and the clock of every host");
  command.add_flag("--flags", watch.table.flags,
                   "in the table every flag of a channel, and below what each of them means");
  command.add_flag("--json", watch.json, "print every change as a line of JSON");
  add_network_options(command, watch.network);
}

using namespace std::chrono_literals;

TableLayout fit_to_terminal(TableLayout layout) {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
    layout.columns = size.ws_col;
    layout.rows = size.ws_row;
  }
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  layout.colour = (no_colour == nullptr || *no_colour == '\0') &&
                  (terminal == nullptr || std::string(terminal) != "dumb");
  return layout;
}

// Over what was there, without a line end after the last line, which would scroll.
void draw(const network::BusState& laboratory, const WatchOptions& command) {
  std::string screen = "\x1b[H";
  bool first = true;
  for (const std::string& line : laboratory_table(laboratory, fit_to_terminal(command.table))) {
    screen += fmt::format("{}{}\x1b[K", first ? "" : "\r\n", line);
    first = false;
  }
  fmt::print("{}\x1b[J", screen);
}

// What has changed since the last time.
class ChangedLines {
public:
  void print(const network::BusState& laboratory, bool json) {
    if (shown_number_ == laboratory.number()) {
      return;
    }
    shown_number_ = laboratory.number();
    if (json) {
      fmt::print("{}\n", json_text(live::laboratory_json(laboratory)));
      return;
    }
    auto lines = laboratory_lines(laboratory);
    for (const auto& [key, line] : lines) {
      const auto before = lines_.find(key);
      if (before == lines_.end() || before->second != line) {
        fmt::print("{}\n", line);
      }
    }
    lines_ = std::move(lines);
  }

private:
  std::optional<std::uint64_t> shown_number_;
  std::map<std::string, std::string> lines_;
};

Expected<void> run_watch(const WatchOptions& command, const std::stop_token& stop) {
  DYNCAL_TRY(const auto watched,
             WatchedLaboratory::open(command.network, "dyncal-watch", command.bench, stop));
  const bool terminal = isatty(STDOUT_FILENO) != 0 && !command.json;
  fmt::print("{}", terminal ? "\x1b[2J" : "");
  ChangedLines changed;
  const auto began = std::chrono::steady_clock::now();
  auto next_output = began;
  const auto over = [&] {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began;
    return watched->is_over() || (command.seconds && passed.count() > *command.seconds);
  };
  while (!over()) {
    watched->work(std::chrono::steady_clock::now() + 200ms);
    if (std::chrono::steady_clock::now() >= next_output) {
      terminal ? draw(watched->laboratory(), command)
               : changed.print(watched->laboratory(), command.json);
      std::fflush(stdout);
      next_output = std::chrono::steady_clock::now() + 1s;
    }
  }
  fmt::print("{}", terminal ? "\n" : "");
  return watched->outcome();
}

const Command watch_command{
    50, "watch",
    "show benches, sources, losses, runs and results as they come, as a table that fits the "
    "terminal",
    add_watch, run_watch};

} // namespace
} // namespace dyncal::inline programs
