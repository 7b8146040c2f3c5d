#include "services/records/replay/recording_player.hpp"

#include <map>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/bus/clock.hpp"
#include "services/records/capture/recorded_topics.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::chrono::seconds listening_time{3}; // a state is repeated at least every 2 s
constexpr std::chrono::milliseconds max_wait{100};
constexpr std::chrono::seconds finding_time{1}; // for readers that are there already
constexpr std::chrono::seconds acknowledgment_limit{5};

// Benches of the file, by its descriptions, states and runs.
Expected<std::string> recorded_bench(recording::RecordingReader& reader) {
  std::set<std::string> benches;
  const auto report = reader.scan({.message = [&](const recording::MessageInFile& message) {
    if (message.channel.topic != bus::topics::source_description.name) {
      return;
    }
    if (const auto one = recording::decode<wire::SourceDescription>(message.message.data)) {
      benches.insert(one->bench().to_string());
    }
  }});
  DYNCAL_TRY(report);
  if (benches.size() != 1) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{}: {}", reader.path().string(),
                    benches.empty()
                        ? std::string("describes no source: there is nothing to replay")
                        : fmt::format("holds several benches: {}", fmt::join(benches, ", "))));
  }
  return *benches.begin();
}

// Who sends as this bench; nothing if nobody was heard.
Expected<std::optional<std::string>>
live_sender(bus::Participant& participant, const std::string& bench, const std::stop_token& stop) {
  const auto wake_up = std::make_shared<bus::WakeUp>();
  DYNCAL_TRY(auto descriptions,
             participant.reader(bus::topics::source_description, bench, wake_up));
  DYNCAL_TRY(auto states, participant.reader(bus::topics::source_status, bench, wake_up));
  DYNCAL_TRY(auto runs, participant.reader(bus::topics::measurement, bench, wake_up));
  bus::Clock& clock = bus::system_clock();
  std::optional<std::string> heard;
  const auto deadline = clock.now() + listening_time;
  while (!heard && clock.now() < deadline && !stop.stop_requested()) {
    clock.wait(*wake_up, std::min(deadline, clock.now() + max_wait));
    descriptions.take([&](const wire::SourceDescription& one) {
      heard = fmt::format("source '{}' on {}", one.source().c_str(), one.host());
    });
    states.take([&](const wire::SourceStatus& one) {
      heard = fmt::format("source '{}'", one.source().c_str());
    });
    runs.take([&](const wire::Measurement& one) {
      heard = fmt::format("run '{}' of {}", one.run().c_str(), one.conductor());
    });
  }
  return heard;
}

template <class T>
void mark(T& message, const std::string& replay) {
  if constexpr (std::is_same_v<T, wire::SourceDescription>) {
    message.driver(replay + ": " + message.driver());
  } else if constexpr (std::is_same_v<T, wire::Measurement>) {
    message.conductor(replay);
  } else if constexpr (std::is_same_v<T, wire::SourceStatus> ||
                       std::is_same_v<T, wire::ServiceStatus>) {
    message.message(message.message().empty() ? replay : replay + ": " + message.message());
  }
}

enum class Played {
  written,
  not_written, // the network did not take it
  left_out
};

struct TopicPlayer {
  std::function<Played(std::string_view bytes)> play;
  std::function<void()> wait_for_acknowledgments;
};

template <class T>
Played play(std::string_view bytes, const std::string& bench, const std::string& replay,
            bus::Writer<T>& writer) {
  auto message = recording::decode<T>(bytes);
  if (!message) {
    return Played::not_written;
  }
  if constexpr (std::is_same_v<T, wire::ServiceStatus>) {
    if (!message->guarded_generator().empty()) {
      return Played::left_out; // a run would rely on a guard that is not there
    }
  }
  message->bench(bench);
  mark(*message, replay);
  return writer.write(*message) == bus::WriteOutcome::written ? Played::written
                                                              : Played::not_written;
}

bool is_result(const std::string& topic) {
  namespace topics = bus::topics;
  return topic == topics::calibration_result || topic == topics::transfer_function ||
         topic == topics::sample_clock_report || topic == topics::service_status;
}

bool is_request(const std::string& topic) {
  return topic == bus::topics::command || topic == bus::topics::catch_up_request;
}

using Players = std::map<std::string, TopicPlayer>;

Expected<Players> open_players(bus::Participant& participant, const ReplayOptions& wish) {
  const std::string replay = "replay of " + wish.recording.filename().string();
  Players players;
  Expected<void> opened;
  recording::for_each_recorded_topic([&]<class T>(const bus::Topic<T>& topic) {
    const std::string name = topic.name;
    if (!opened || is_request(name) || (is_result(name) && !wish.results)) {
      return;
    }
    auto opened_writer = participant.writer(topic, wish.bench);
    if (!opened_writer) {
      opened = fail(opened_writer.error());
      return;
    }
    const auto writer = std::make_shared<bus::Writer<T>>(std::move(*opened_writer));
    players[name] = {[=, bench = wish.bench](std::string_view bytes) {
                       return play(bytes, bench, replay, *writer);
                     },
                     [=] { writer->wait_for_acknowledgments(acknowledgment_limit); }};
  });
  DYNCAL_TRY(opened);
  return players;
}

// When what was recorded at a time is due.
class Pace {
public:
  explicit Pace(double speed) : speed_(speed), began_(bus::system_clock().now() + finding_time) {}

  void wait_for_readers(const std::stop_token& stop) { wait_until(began_, stop); }
  void wait_for(std::uint64_t log_time, const std::stop_token& stop) {
    if (!first_) {
      first_ = log_time;
    }
    if (speed_ <= 0.0 || log_time <= *first_) {
      return;
    }
    wait_until(began_ + std::chrono::nanoseconds(static_cast<std::int64_t>(
                            static_cast<double>(log_time - *first_) / speed_)),
               stop);
  }

private:
  void wait_until(bus::Clock::Instant due, const std::stop_token& stop) {
    bus::Clock& clock = bus::system_clock();
    while (!stop.stop_requested() && clock.now() < due) {
      clock.wait(nobody_, std::min(due, clock.now() + max_wait));
    }
  }

  double speed_;
  bus::Clock::Instant began_;
  std::optional<std::uint64_t> first_;
  bus::WakeUp nobody_;
};

} // namespace

Expected<RecordingPlayer> RecordingPlayer::open(bus::Participant& participant, ReplayOptions wish,
                                                const std::stop_token& stop) {
  DYNCAL_TRY(auto reader, recording::RecordingReader::open(wish.recording));
  DYNCAL_TRY(auto bench, recorded_bench(reader));
  if (wish.bench.empty()) {
    wish.bench = bench;
  }
  DYNCAL_TRY(bus::check_bench_name(wish.bench));
  DYNCAL_TRY(const auto live, live_sender(participant, wish.bench, stop));
  if (live) {
    return fail(ErrorCode::no_source,
                fmt::format("bench '{}' is live in this domain ({}), and recorded samples must not "
                            "be taken for its own: give the replay another name of the bench "
                            "(--bench) or another domain (--domain)",
                            wish.bench, *live));
  }
  return RecordingPlayer(participant, std::move(wish), std::move(reader));
}

Expected<ReplayFigures> RecordingPlayer::play(const std::stop_token& stop) {
  DYNCAL_TRY(auto players, open_players(*participant_, wish_));
  ReplayFigures figures;
  Pace pace(wish_.speed);
  pace.wait_for_readers(stop);
  auto report = reader_.scan({.message = [&](const recording::MessageInFile& message) {
    const auto player = players.find(message.channel.topic);
    if (stop.stop_requested() || player == players.end()) {
      ++figures.left_out;
      return;
    }
    pace.wait_for(message.message.log_time, stop);
    const Played played = player->second.play(message.message.data);
    ++(played == Played::written    ? figures.written
       : played == Played::left_out ? figures.left_out
                                    : figures.not_written);
  }});
  DYNCAL_TRY(report);
  figures.report = std::move(*report);
  for (const auto& [topic, player] : players) {
    player.wait_for_acknowledgments();
  }
  return figures;
}

} // namespace dyncal::inline records
