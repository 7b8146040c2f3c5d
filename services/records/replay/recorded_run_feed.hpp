// Hands what was recorded of one run to its evaluation, in a walk through the file, and keeps what
// comes out.
//
// Samples of each source go in the order of their numbers, wherever they stand, from the source's
// answer on; those of a session of something else (another bench file, other channels) are left
// out. A new session waits, as it did live, while steps of the one before may still be evaluated.
// What the conductor said counts once all sources have come to it (waiting_announcements.hpp);
// times are those of the recorder's clock. Results take the way of the contract's messages.
//
// Where the evaluation is given up (RunEvaluator::give_up) nothing more is done, and the outcome is
// not whole.
//
// Fails (no_source) as RunEvaluator::describe(), (bad_file) as RecordedMessages. One thread.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/evaluation/result/run_outcome.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/records/replay/recorded_messages.hpp"
#include "services/records/replay/recording_index.hpp"
#include "services/records/replay/waiting_announcements.hpp"

namespace dyncal::inline records {

class RecordedRunFeed {
public:
  // All outlive the object.
  RecordedRunFeed(const recording::RecordingReader& reader, const RecordedRunIndex& index,
                  RunEvaluator& evaluator, RunOutcome& outcome);

  // In the order of the file.
  void take(const recording::MessageInFile& message);
  [[nodiscard]] Expected<void> finish(bool aborted);

private:
  struct WaitingBlock {
    wire::SampleBlock block;
    std::int64_t sent_ns;
  };
  struct Source {
    const RecordedSource& recorded;
    std::map<RecordedPosition, RecordedPlace>::const_iterator next{};
    bool answered = false;
    std::optional<std::uint64_t> described{}; // session
    drivers::SourceDescription first{};       // what the run began with
    // As far as the file has been walked, the newest of each session.
    std::map<std::uint64_t, std::vector<drivers::QuadratureSignals>> signals{};
    std::deque<WaitingBlock> waiting{};
    std::uint64_t waiting_since = 0;
    // Its session: the run cannot go by what it describes
    // (services/programs/analysis/source_streams.hpp).
    bool is_unfit = false;
  };

  void take_excitation(const recording::MessageInFile& message);
  void take_state(const recording::MessageInFile& message);
  void take_description(const recording::MessageInFile& message);
  void take_reference_step(const recording::MessageInFile& message);
  template <class T>
  void take_of_source(const recording::MessageInFile& message);
  void add(const std::string& name, Source& source, const wire::SampleBlock& block,
           std::int64_t sent_ns);
  void add(const std::string& name, Source& source, const wire::TriggeredRecord& record,
           std::int64_t sent_ns);
  void describe(const std::string& name, Source& source, std::uint64_t session);
  void hand_over_waiting(const std::string& name, Source& source, bool at_once);
  void announce(bool at_once);
  void collect_output();
  [[nodiscard]] WaitingAnnouncements::Instant here() const {
    return {walked_, static_cast<std::int64_t>(now_)};
  }

  RunEvaluator& evaluator_;
  RunOutcome& outcome_;
  RecordedMessages others_;
  std::string bench_;
  std::string run_;
  std::map<std::string, Source> sources_;
  std::uint64_t now_ = 0; // log_time
  std::uint64_t walked_ = 0;
  WaitingAnnouncements announcements_;
  Expected<void> outcome_of_walk_;
};

} // namespace dyncal::inline records
