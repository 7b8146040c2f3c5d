#include "services/programs/command/watch_command.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <map>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/programs/command/laboratory_lines.hpp"
#include "services/programs/command/laboratory_table.hpp"
#include "services/programs/command/watched_laboratory.hpp"
#include "services/views/live/laboratory_json.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

TableLayout layout_of_terminal(const WatchCommand& command) {
  TableLayout layout;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
    layout.columns = size.ws_col;
    layout.rows = size.ws_row;
  }
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  layout.colour = (no_colour == nullptr || *no_colour == '\0') &&
                  (terminal == nullptr || std::string(terminal) != "dumb");
  layout.all = command.all;
  layout.flags = command.flags;
  return layout;
}

// Over what was there, without a line end after the last line, which would scroll.
void draw(const network::BusState& laboratory, const WatchCommand& command) {
  std::string screen = "\x1b[H";
  bool first = true;
  for (const std::string& line : laboratory_table(laboratory, layout_of_terminal(command))) {
    screen += fmt::format("{}{}\x1b[K", first ? "" : "\r\n", line);
    first = false;
  }
  fmt::print("{}\x1b[J", screen);
}

// What has changed since the last time.
class Output {
public:
  Output(const WatchCommand& command, bool terminal) : command_(command), terminal_(terminal) {
    if (terminal_) {
      fmt::print("\x1b[2J");
    }
  }
  ~Output() {
    if (terminal_) {
      fmt::print("\n");
    }
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void show(const network::BusState& laboratory) {
    if (terminal_) {
      draw(laboratory, command_);
    } else if (shown_number_ != laboratory.number()) {
      shown_number_ = laboratory.number();
      command_.json ? print_json(laboratory) : print_lines(laboratory);
    }
    std::fflush(stdout);
  }

private:
  static void print_json(const network::BusState& laboratory) {
    fmt::print("{}\n", json_text(live::laboratory_json(laboratory)));
  }

  void print_lines(const network::BusState& laboratory) {
    auto lines = laboratory_lines(laboratory);
    for (const auto& [key, line] : lines) {
      const auto before = lines_.find(key);
      if (before == lines_.end() || before->second != line) {
        fmt::print("{}\n", line);
      }
    }
    lines_ = std::move(lines);
  }

  const WatchCommand& command_;
  bool terminal_;
  std::optional<std::uint64_t> shown_number_;
  std::map<std::string, std::string> lines_;
};

} // namespace

int run_watch(const WatchCommand& command, const std::stop_token& stop) {
  const auto watched =
      WatchedLaboratory::open(command.network, "dyncal-watch", command.bench, stop);
  if (!watched) {
    return report_error(watched.error());
  }
  Output output(command, isatty(STDOUT_FILENO) != 0 && !command.json);
  const auto began = std::chrono::steady_clock::now();
  auto next_output = began;
  const auto over = [&] {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began;
    return (*watched)->is_over() || (command.seconds && passed.count() > *command.seconds);
  };
  while (!over()) {
    (*watched)->work(std::chrono::steady_clock::now() + 200ms);
    if (std::chrono::steady_clock::now() >= next_output) {
      output.show((*watched)->laboratory());
      next_output = std::chrono::steady_clock::now() + 1s;
    }
  }
  const auto heard = (*watched)->outcome();
  return heard ? 0 : report_error(heard.error());
}

} // namespace dyncal::inline programs
