#include "services/records/replay/recording_index.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/byte_count.hpp"
#include "services/contract/number_in_source.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/result/run_pause.hpp"
#include "services/records/capture/recorded_topics.hpp"

namespace dyncal::inline records {
namespace {

// Everything that the first walk gathers, of all runs.
class Gathering {
public:
  void take(const recording::MessageInFile& message) {
    recording::for_each_recorded_topic([&]<class T>(const bus::Topic<T>& topic) {
      if constexpr (is_looked_at<T>) {
        if (message.channel.topic == topic.name) {
          if (const auto decoded = recording::decode<T>(message.message.data)) {
            take(*decoded, message);
          } else {
            ++undecodable_;
          }
        }
      }
    });
  }

  [[nodiscard]] RecordingContents contents() {
    RecordingContents contents;
    contents.runs = std::move(runs_);
    for (auto& [name, run] : contents.runs) {
      if (const auto first = first_announced_.find(name); first != first_announced_.end()) {
        run.first_announced = first->second;
      }
    }
    for (const auto& [key, source] : sources_) {
      contents.sources.emplace(key, ordered(source));
    }
    return contents;
  }
  [[nodiscard]] std::uint64_t undecodable() const { return undecodable_; }

private:
  template <class T>
  static constexpr bool is_looked_at =
      recording::is_of_source<T> || std::is_same_v<T, wire::Measurement> ||
      std::is_same_v<T, wire::Excitation> || std::is_same_v<T, wire::SourceDescription> ||
      std::is_same_v<T, wire::ServiceStatus> || std::is_same_v<T, wire::SampleClockReport> ||
      std::is_same_v<T, wire::CalibrationResult>;

  struct Session {
    std::int64_t min_delay_ns = 0; // from its source's clock to the recorder's
    std::map<std::uint64_t, RecordedPlace> messages;
  };
  struct Source {
    std::map<std::uint64_t, wire::SourceDescription> descriptions;
    std::optional<wire::SourceDescription> newest;
    std::map<std::uint64_t, Session> sessions;
    std::set<std::string> answered;
    bool triggered = false;
  };
  using SourceKey = std::pair<std::string, std::string>; // bench and source

  void take(const wire::Measurement& measurement, const recording::MessageInFile& message) {
    const auto [found, is_new] = runs_.try_emplace(measurement.run().to_string());
    RecordedRunIndex& run = found->second;
    if (is_new) {
      run.plan = measurement;
    }
    run.newest = measurement;
    const auto state = measurement.state();
    if (state == wire::MEASUREMENT_RUNNING && run.began == 0) {
      run.began = message.message.log_time;
    }
    take_pause(measurement, static_cast<std::int64_t>(message.message.log_time), run);
    if ((state == wire::MEASUREMENT_DONE || state == wire::MEASUREMENT_ABORTED) && run.ended == 0) {
      run.ended = message.message.log_time;
    }
  }
  void take(const wire::Excitation& excitation, const recording::MessageInFile& /*message*/) {
    first_announced_.try_emplace(excitation.run().to_string(), excitation);
  }
  static void take_pause(const wire::Measurement& measurement, std::int64_t time_utc_ns,
                         RecordedRunIndex& run) {
    if (measurement.state() == wire::MEASUREMENT_RUNNING && !measurement.message().empty()) {
      note_pause(run.pauses, time_utc_ns, measurement.message());
    } else {
      end_pause(run.pauses, time_utc_ns);
    }
  }
  void take(const wire::SourceDescription& description,
            const recording::MessageInFile& /*message*/) {
    Source& source = sources_[{description.bench().to_string(), description.source().to_string()}];
    source.descriptions[description.session()] = description;
    source.newest = description;
  }
  void take(const wire::ServiceStatus& status, const recording::MessageInFile& /*message*/) {
    if (status.arm() == wire::ARM_ARMED || status.arm() == wire::ARM_FINISHED) {
      if (const auto run = runs_.find(status.run().to_string()); run != runs_.end()) {
        run->second.analysis = status;
      }
    }
  }
  void take(const wire::SampleClockReport& report, const recording::MessageInFile& /*message*/) {
    const auto run = runs_.find(report.run().to_string());
    if (run != runs_.end() && report.last_session() != 0) {
      run->second.clock_end = BlockPosition{report.last_session(), report.last_block()};
    }
  }
  void take(const wire::CalibrationResult& result, const recording::MessageInFile& /*message*/) {
    if (const auto run = runs_.find(result.run().to_string()); run != runs_.end()) {
      ++run->second.live_results;
    }
  }
  template <class T>
  void take(const T& message, const recording::MessageInFile& in_file) {
    Source& source = sources_[{message.bench().to_string(), message.source().to_string()}];
    source.triggered = std::is_same_v<T, wire::TriggeredRecord>;
    if (!message.acknowledged_run().empty()) {
      source.answered.insert(message.acknowledged_run());
    }
    const std::uint64_t number = contract::number_in_source(message);
    if (std::is_same_v<T, wire::TriggeredRecord> && number == 0) {
      return;
    }
    const auto [found, is_new] = source.sessions.try_emplace(message.session());
    Session& session = found->second;
    const std::int64_t delay_ns =
        static_cast<std::int64_t>(in_file.message.log_time) - message.received_utc_ns();
    session.min_delay_ns = is_new ? delay_ns : std::min(session.min_delay_ns, delay_ns);
    session.messages.try_emplace(
        number, RecordedPlace{in_file.chunk, in_file.position, message.received_utc_ns()});
  }

  [[nodiscard]] static RecordedSource ordered(const Source& source) {
    RecordedSource one;
    one.descriptions = source.descriptions;
    one.newest = source.newest;
    one.answered = source.answered;
    one.triggered = source.triggered;
    for (const auto& [session, messages] : source.sessions) {
      one.sessions.push_back(session);
    }
    const auto beginning = [&source](std::uint64_t session) {
      const RecordedPlace& first = source.sessions.at(session).messages.begin()->second;
      return std::make_pair(first.chunk, first.position);
    };
    std::ranges::sort(one.sessions, {}, beginning);
    for (std::size_t i = 0; i < one.sessions.size(); ++i) {
      const Session& session = source.sessions.at(one.sessions[i]);
      for (auto [number, place] : session.messages) {
        place.sent_ns += session.min_delay_ns;
        one.messages.emplace(RecordedPosition{i, number}, place);
      }
    }
    return one;
  }

  std::map<std::string, RecordedRunIndex> runs_;
  std::map<std::string, wire::Excitation> first_announced_; // by run, which may be stored behind it
  std::map<SourceKey, Source> sources_;
  std::uint64_t undecodable_ = 0;
};

} // namespace

RecordedPosition RecordedSource::position(std::uint64_t session, std::uint64_t number) const {
  const auto found = std::find(sessions.begin(), sessions.end(), session);
  return {static_cast<std::size_t>(found - sessions.begin()), number};
}

Expected<RecordingContents> index_contents(recording::RecordingReader& reader,
                                           const SharedWorkCount& count,
                                           const std::stop_token& stop) {
  ByteCount bytes(count, "reading", reader.size_bytes());
  Gathering gathering;
  auto report = reader.scan(
      {.message = [&](const recording::MessageInFile& message) { gathering.take(message); },
       .walked =
           [&](std::uint64_t walked) {
             bytes.set_done(walked);
             return !stop.stop_requested();
           }});
  DYNCAL_TRY(report);
  if (gathering.undecodable() > 0) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: {} messages are not of the contract of this version: read it with "
                            "the version that wrote it ({})",
                            reader.path().string(), gathering.undecodable(), report->library));
  }
  RecordingContents contents = gathering.contents();
  contents.report = std::move(*report);
  return contents;
}

Expected<RecordedRunIndex> index_recording(recording::RecordingReader& reader,
                                           const std::string& run, const SharedWorkCount& count,
                                           const std::stop_token& stop) {
  DYNCAL_TRY(auto contents, index_contents(reader, count, stop));
  const std::string path = reader.path().string();
  if (contents.runs.empty()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: holds no run (no Measurement)", path));
  }
  std::vector<std::string> names;
  for (const auto& [name, one] : contents.runs) {
    names.push_back(name);
  }
  if (run.empty() && names.size() > 1) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: holds several runs ({}): name one with --run", path,
                            fmt::join(names, ", ")));
  }
  const auto found = contents.runs.find(run.empty() ? names.front() : run);
  if (found == contents.runs.end()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: holds no run '{}', but: {}", path, run, fmt::join(names, ", ")));
  }
  RecordedRunIndex index = std::move(found->second);
  const std::string bench = index.plan.bench().to_string();
  for (auto& [key, source] : contents.sources) {
    if (key.first == bench) {
      index.sources.emplace(key.second, std::move(source));
    }
  }
  index.report = std::move(contents.report);
  return index;
}

} // namespace dyncal::inline records
