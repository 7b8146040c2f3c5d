#include "services/programs/command/replay_command.hpp"

#include <charconv>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/daemon/program/watched_network.hpp"

namespace dyncal::inline programs {
namespace {

Expected<double> parse_speed(const std::string& text) {
  if (text == "max") {
    return 0.0;
  }
  double speed = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), speed);
  if (error != std::errc() || end != text.data() + text.size() || !(speed > 0.0)) {
    return fail(
        ErrorCode::bad_argument,
        fmt::format("invalid --speed '{}': give a multiple of real time above 0, or max", text));
  }
  return speed;
}

Expected<ReplayFigures> replay(const ReplayCommand& command, const std::stop_token& asked) {
  ReplayOptions wish = command.wish;
  wish.results = !command.without_results;
  DYNCAL_TRY(wish.speed, parse_speed(command.speed));
  DYNCAL_TRY(const auto joined, WatchedNetwork::join(command.network, "dyncal-replay", asked));
  const std::stop_token stop = joined->stop();
  DYNCAL_TRY(auto player, RecordingPlayer::open(joined->participant, std::move(wish), stop));
  fmt::print("replaying {} as bench '{}'\n", command.wish.recording.string(),
             one_line(player.bench()));
  return player.play(stop);
}

} // namespace

int run_replay(const ReplayCommand& command, const std::stop_token& stop) {
  const auto figures = replay(command, stop);
  if (!figures) {
    return report_error(figures.error());
  }
  fmt::print("{} messages were put on the network, {} left out, {} not taken; {} places of the "
             "recording are damaged\n",
             figures->written, figures->left_out, figures->not_written,
             figures->report.damage_count);
  if (stop.stop_requested()) {
    return report_error({ErrorCode::interrupted, "interrupted"});
  }
  return figures->not_written == 0 && figures->report.damage_count == 0
             ? 0
             : report_error({ErrorCode::no_result, "not everything that was recorded was put on "
                                                   "the network"});
}

} // namespace dyncal::inline programs
