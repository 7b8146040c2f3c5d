// `dyncal list`: benches with their sources and runs that are on the network now, once. It listens
// until nothing new has come for a second, for `seconds` at most. Belongs to one thread.
#include <algorithm>
#include <chrono>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/contract/run_identity.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/harmless_text.hpp"
#include "services/programs/command/watched_laboratory.hpp"
#include "services/views/live/laboratory_json.hpp"

namespace dyncal::inline programs {
namespace {

struct ListOptions {
  std::string bench = "*";
  double seconds = 5.0;
  bool json = false;
  NetworkOptions network;
};

void add_list(CLI::App& command, ListOptions& list) {
  command.add_option("--bench", list.bench, "only this bench (default: all)");
  add_default(command, "--seconds", list.seconds, "listen for this time at the most",
              CLI::PositiveNumber);
  command.add_flag("--json", list.json, "print JSON");
  add_network_options(command, list.network);
}

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// Programs are matched, and tell what they keep for late listeners, within this.
constexpr auto quiet_time = 1s;

std::string source_text(const network::Source& source) {
  std::string device = source.description ? source.description->device : "";
  if (source.description && !source.description->serial.empty()) {
    device += (device.empty() ? "" : " ") + source.description->serial;
  }
  const std::size_t channels = source.description ? source.description->channels.size() : 0;
  return fmt::format("  source {}  {}  {:.1f} S/s  {} channels  {}  on {}", harmless(source.name),
                     source.is_silent ? "silent" : to_string(source.state), source.rate_hz,
                     channels, harmless(device), harmless(source.host));
}

std::string run_text(const network::Run& run) {
  return fmt::format("  run {}  {}  {} results{}", harmless(RunIdentity::parse(run.name).name),
                     to_string(run.state()), run.results.size(),
                     run.message.empty() ? "" : "  " + harmless(run.message));
}

void print_text(const network::BusState& laboratory) {
  const auto now = laboratory.clock().now();
  for (const auto& [name, bench] : laboratory.benches()) {
    const network::Condition condition = condition_of(bench, now);
    fmt::print("bench {}  {}{}\n", harmless(name), to_string(state_of(bench, now)),
               condition.what.empty() ? "" : "  " + harmless(condition.what));
    for (const auto& [source_name, source] : bench.sources) {
      fmt::print("{}\n", source_text(source));
    }
    for (const auto& [service_name, service] : bench.services) {
      const char* kind = service.is_recorder() ? "recorder"
                         : service.is_guard()  ? "guard"
                                               : "analysis";
      fmt::print("  {} {}  {}\n", kind, harmless(service_name), to_string(service.health));
    }
    for (const auto& [run_name, run] : bench.runs) {
      fmt::print("{}\n", run_text(run));
    }
  }
  if (laboratory.benches().empty()) {
    fmt::print("nothing on this DDS domain; 'dyncal doctor' looks for the reason\n");
  }
}

Expected<void> run_list(const ListOptions& command, const std::stop_token& stop) {
  DYNCAL_TRY(const auto watched,
             WatchedLaboratory::open(command.network, "dyncal-list", command.bench, stop));
  const network::BusState& laboratory = watched->laboratory();
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(command.seconds));
  auto number_of_things = std::size_t{0};
  // Who may not be talked to is known after two announcements.
  auto quiet_at = Clock::now() + (command.network.security.empty() ? 2 : 4) * quiet_time;
  while (!watched->is_over() && Clock::now() < std::min(deadline, quiet_at)) {
    watched->work(Clock::now() + 100ms);
    std::size_t things = laboratory.programs().size();
    for (const auto& [name, bench] : laboratory.benches()) {
      things += 1 + bench.sources.size() + bench.services.size() + bench.runs.size();
    }
    if (things != number_of_things) {
      number_of_things = things;
      quiet_at = Clock::now() + quiet_time;
    }
  }
  const std::string strangers = watched->strangers();
  if (command.json) {
    auto json = live::laboratory_json(laboratory);
    json["strangers"] = strangers;
    fmt::print("{}\n", json_text(json, 2));
  } else {
    print_text(laboratory);
    fmt::print("{}", strangers.empty() ? "" : harmless(strangers) + "\n");
  }
  return watched->outcome();
}

const Command list_command{60, "list",
                           "list the benches, sources and runs that are on the network now",
                           add_list, run_list};

} // namespace
} // namespace dyncal::inline programs
