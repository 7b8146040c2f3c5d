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
  const auto report =
      reader.scan({.message =
                       [&](const recording::MessageInFile& message) {
                         if (message.channel.topic != bus::topics::source_description.name) {
                           return;
                         }
                         if (const auto one =
                                 recording::decode<wire::SourceDescription>(message.message.data)) {
                           benches.insert(one->bench().to_string());
                         }
                       },
                   .attachment = {},
                   .metadata = {}});
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

void mark(wire::SourceDescription& message, const std::string& replay) {
  message.driver(replay + ": " + message.driver());
}
void mark(wire::SourceStatus& message, const std::string& replay) {
  message.message(message.message().empty() ? replay : replay + ": " + message.message());
}
void mark(wire::ServiceStatus& message, const std::string& replay) {
  message.message(message.message().empty() ? replay : replay + ": " + message.message());
}
void mark(wire::Measurement& message, const std::string& replay) {
  message.conductor(replay);
}
template <class T>
void mark(T& /*message*/, const std::string& /*replay*/) {}

// A run would rely on a guard that is not there.
bool is_left_out(const wire::ServiceStatus& message) {
  return !message.guarded_generator().empty();
}
template <class T>
bool is_left_out(const T& /*message*/) {
  return false;
}

enum class Played {
  written,
  not_written, // the network did not take it
  left_out
};

class TopicPlayer {
public:
  virtual ~TopicPlayer() = default;
  virtual Played play(std::string_view bytes, const std::string& bench,
                      const std::string& replay) = 0;
  virtual bool wait_for_acknowledgments(std::chrono::nanoseconds limit) = 0;
};

template <class T>
class PlayerOf : public TopicPlayer {
public:
  explicit PlayerOf(bus::Writer<T> writer) : writer_(std::move(writer)) {}
  Played play(std::string_view bytes, const std::string& bench,
              const std::string& replay) override {
    auto message = recording::decode<T>(bytes);
    if (!message) {
      return Played::not_written;
    }
    if (is_left_out(*message)) {
      return Played::left_out;
    }
    message->bench(bench);
    mark(*message, replay);
    return writer_.write(*message) == bus::WriteOutcome::written ? Played::written
                                                                 : Played::not_written;
  }
  bool wait_for_acknowledgments(std::chrono::nanoseconds limit) override {
    return writer_.wait_for_acknowledgments(limit);
  }

private:
  bus::Writer<T> writer_;
};

bool is_result(const std::string& topic) {
  namespace topics = bus::topics;
  return topic == topics::calibration_result || topic == topics::transfer_function ||
         topic == topics::sample_clock_report || topic == topics::service_status;
}

bool is_request(const std::string& topic) {
  return topic == bus::topics::command || topic == bus::topics::catch_up_request;
}

using Players = std::map<std::string, std::unique_ptr<TopicPlayer>>;

Expected<Players> open_players(bus::Participant& participant, const std::string& bench,
                               bool results) {
  Players players;
  Expected<void> opened;
  recording::for_each_recorded_topic([&]<class T>(const bus::Topic<T>& topic) {
    const std::string name = topic.name;
    if (!opened || is_request(name) || (is_result(name) && !results)) {
      return;
    }
    auto writer = participant.writer(topic, bench);
    if (!writer) {
      opened = fail(writer.error());
      return;
    }
    players.emplace(name, std::make_unique<PlayerOf<T>>(std::move(*writer)));
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
  DYNCAL_TRY(auto players, open_players(*participant_, wish_.bench, wish_.results));
  const std::string replay = "replay of " + wish_.recording.filename().string();
  ReplayFigures figures;
  Pace pace(wish_.speed);
  pace.wait_for_readers(stop);
  auto report = reader_.scan({.message =
                                  [&](const recording::MessageInFile& message) {
                                    const auto player = players.find(message.channel.topic);
                                    if (stop.stop_requested() || player == players.end()) {
                                      ++figures.left_out;
                                      return;
                                    }
                                    pace.wait_for(message.message.log_time, stop);
                                    const Played played = player->second->play(message.message.data,
                                                                               wish_.bench, replay);
                                    ++(played == Played::written    ? figures.written
                                       : played == Played::left_out ? figures.left_out
                                                                    : figures.not_written);
                                  },
                              .attachment = {},
                              .metadata = {}});
  DYNCAL_TRY(report);
  figures.report = std::move(*report);
  for (const auto& [topic, player] : players) {
    player->wait_for_acknowledgments(acknowledgment_limit);
  }
  return figures;
}

} // namespace dyncal::inline records
