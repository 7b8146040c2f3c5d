// `dyncal replay RECORDING`: puts a recording back on DDS
// (services/records/replay/recording_player.hpp). Belongs to one thread.

#include <fmt/core.h>

#include "services/base/parsed_number.hpp"
#include "services/base/printable_text.hpp"
#include "services/daemon/program/watched_network.hpp"
#include "services/programs/command/command.hpp"
#include "services/records/replay/recording_player.hpp"

namespace dyncal::inline programs {
namespace {

struct ReplayCommand {
  ReplayOptions wish;
  std::string speed = "1"; // multiple of real time, or "max"
  bool without_results = false;
  NetworkOptions network;
};

void add_replay(CLI::App& command, ReplayCommand& replay) {
  command.add_option("RECORDING", replay.wish.recording, "recording (.mcap)")->required();
  add_default(command, "--speed", replay.speed, "multiple of real time, or max");
  command.add_option("--bench", replay.wish.bench,
                     "name of the bench on DDS (default: as it was recorded)");
  command.add_flag("--without-results", replay.without_results,
                   "leave out results and states of the analysis: a running analysis service "
                   "evaluates the run again");
  add_network_options(command, replay.network);
}

Expected<double> parse_speed(const std::string& text) {
  if (text == "max") {
    return 0.0;
  }
  const auto speed = parsed_number<double>(text);
  if (!speed || !(*speed > 0.0)) {
    return fail(
        ErrorCode::bad_argument,
        fmt::format("invalid --speed '{}': give a multiple of real time above 0, or max", text));
  }
  return *speed;
}

Expected<void> run_replay(ReplayCommand& command, const std::stop_token& asked) {
  command.wish.results = !command.without_results;
  DYNCAL_TRY(command.wish.speed, parse_speed(command.speed));
  DYNCAL_TRY(const auto joined, WatchedNetwork::join(command.network, "dyncal-replay", asked));
  const std::stop_token stop = joined->stop();
  DYNCAL_TRY(auto player, RecordingPlayer::open(joined->participant, command.wish, stop));
  fmt::print("replaying {} as bench '{}'\n", command.wish.recording.string(),
             one_line(player.bench()));
  DYNCAL_TRY(const auto figures, player.play(stop));
  fmt::print("{} messages were put on the network, {} left out, {} not taken; {} places of the "
             "recording are damaged\n",
             figures.written, figures.left_out, figures.not_written, figures.report.damage_count);
  if (asked.stop_requested()) {
    return fail(ErrorCode::interrupted, "interrupted");
  }
  return figures.not_written == 0 && figures.report.damage_count == 0
             ? Expected<void>{}
             : fail(ErrorCode::no_result,
                    "not everything that was recorded was put on the network");
}

const Command replay_command{150, "replay", "put a recording back on DDS, marked as a replay",
                             add_replay, run_replay};

} // namespace
} // namespace dyncal::inline programs
