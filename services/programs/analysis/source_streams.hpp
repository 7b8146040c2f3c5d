// The sources of one run as the analysis sees them: who has described itself, who has answered, and
// what each has sent; their samples go to the run's evaluator.
//
// Samples of a source count from its answer on: a block or record that names the run
// (idl/README.md, "The run protocol"). What comes before is not of this run. They are handed over
// in order and without a break as long as the source can close it (stream_follower.hpp), also when
// the run began before this service. Readers are opened when a source's kind is known, one a topic;
// those of answers to requests when the first is due. A source that has restarted is waited with
// for up to `session_limit` where the evaluator still needs what it sent before. One that describes
// itself in the middle of a run as something the run cannot go by (other channels, another bench
// file, another instrument) counts as lost until it describes itself otherwise. Samples wait
// meanwhile (waiting_blocks.hpp). Those of a session that describes itself in no way are left out
// after `session_limit`, and its source counts as lost: another's description says nothing of them.
// A session has one writer: the program that was heard first in it. Blocks of another one are left
// out and counted, and the steps that they come in are flagged; records of another one end the run,
// for nothing tells which step they spoil. Both programs are named as DDS discovery knows them.
// Belongs to the run's one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/contract/known_sources.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/programs/analysis/handed_out_steps.hpp"
#include "services/programs/analysis/left_out_messages.hpp"
#include "services/programs/analysis/source_stream.hpp"

namespace dyncal::inline programs {

class SourceStreams {
public:
  using Instant = bus::Clock::Instant;

  static constexpr std::chrono::seconds session_limit{5};

  enum class Begin { with_answer, behind }; // behind: the run began before this service

  struct Request {
    std::string source;
    CatchUp what;
  };

  // `participant` and `evaluator` outlive the object. What is left out is counted in `left_out`.
  SourceStreams(bus::Participant& participant, std::shared_ptr<bus::WakeUp> wake_up,
                std::shared_ptr<LeftOutMessages> left_out, std::string bench, std::string run,
                RunEvaluator& evaluator, Begin begin);
  SourceStreams(const SourceStreams&) = delete;
  SourceStreams& operator=(const SourceStreams&) = delete;

  [[nodiscard]] bool contains(const std::string& source) const { return streams_.contains(source); }
  // Hands new descriptions to the evaluator. Fails as RunEvaluator::describe() and readers do.
  [[nodiscard]] Expected<void> take_descriptions(const KnownSources& known, Instant now);
  // Hands what has come of sources that have answered to the evaluator: samples, and steps that a
  // source has evaluated itself.
  void take_samples(Instant now);
  // A sentence about the steps that such a source has not handed out yet; empty: none.
  [[nodiscard]] std::string steps_not_handed_out() const;
  // How many it has.
  [[nodiscard]] std::size_t steps_handed_out() const { return steps_ ? steps_->count() : 0; }
  // What sources are to be asked for, by asker(). Fails as readers do.
  [[nodiscard]] Expected<std::vector<Request>> requests_due(Instant now);
  [[nodiscard]] const std::string& asker() const { return asker_; }

  // One sentence about the first source that no longer has what it sent at the beginning of a run
  // that began before this service; empty if none. Steps would be taken for others.
  [[nodiscard]] std::string lost_beginning() const;
  // Some source's messages are behind what it has sent.
  [[nodiscard]] bool is_catching_up() const;
  // What some source sends now does not reach the evaluator: it is not there, or silent
  // (stream_follower.hpp), or its samples wait.
  [[nodiscard]] bool is_held_up(Instant now) const;
  // Messages that had to be asked for.
  [[nodiscard]] std::uint64_t recovered() const;

  // One sentence about the first source in whose name two programs have sent in one session; empty:
  // none.
  [[nodiscard]] std::string second_writer() const;

  // Sources that have described themselves and are to be asked for an answer.
  [[nodiscard]] std::vector<std::string> unanswered() const;
  // One sentence about the first source that keeps the run from being armed; empty if none does.
  [[nodiscard]] std::optional<MissingSource> what_is_missing(const KnownSources& known) const;
  // One sentence about the first source whose service has read another bench file than the run, by
  // the settings that the run has for each; empty if none has.
  [[nodiscard]] std::string
  settings_mismatch(const std::map<std::string, std::string>& settings_of_run) const;
  // The first source without which the run cannot go on: it sent nothing for `silence_limit` since
  // its last block and since `watched_from`, or, if `may_not_end`, it ended.
  [[nodiscard]] std::optional<LostSource> lost_source(Instant now, Instant watched_from,
                                                      std::chrono::seconds silence_limit,
                                                      bool may_not_end) const;

private:
  using Stream = SourceStream;

  [[nodiscard]] bool is_described(const Stream& stream, std::uint64_t session) const;
  [[nodiscard]] Expected<void> describe(const std::string& name, Stream& stream,
                                        const wire::SourceDescription& description, Instant now);
  // Why the run cannot go on by this description of a source that it knows; empty: it can.
  [[nodiscard]] std::string rejection_reason(const std::string& name,
                                             const wire::SourceDescription& description);
  [[nodiscard]] Stream::Follower make_follower(const std::string& name, bool triggered);
  template <class Message>
  [[nodiscard]] Expected<void>
  open_reader(std::map<wire::SourceKind, bus::Reader<Message>>& readers, wire::SourceKind kind);
  [[nodiscard]] Expected<void> open_answer_readers();
  [[nodiscard]] Expected<void> open_steps(const std::string& name);
  void take_steps();
  template <class Message, class Take>
  void take(bus::Reader<Message>& reader, Take take);
  void note_second_writer(const std::string& name, Stream& stream, std::uint64_t session,
                          const bus::WriterId& writer);
  void hand_over(const std::string& name, Stream& stream, const wire::SampleBlock& block);
  void add(const std::string& name, const wire::SampleBlock& block);
  void hand_over_waiting(const std::string& name, Stream& stream, Instant now);

  bus::Participant& participant_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::shared_ptr<LeftOutMessages> left_out_;
  std::string bench_;
  std::string run_;
  std::string asker_;
  RunEvaluator& evaluator_;
  Begin begin_;
  Instant heard_{}; // what is taken now
  std::map<std::string, Stream> streams_;
  std::map<wire::SourceKind, bus::Reader<wire::SampleBlock>> block_readers_;
  std::map<wire::SourceKind, bus::Reader<wire::TriggeredRecord>> record_readers_;
  std::optional<HandedOutSteps> steps_; // of the recipe's reference_table
  struct AnswerReaders {
    bus::Reader<wire::SampleBlock> blocks;
    bus::Reader<wire::TriggeredRecord> records;
  };
  std::optional<AnswerReaders> answer_readers_;
};

} // namespace dyncal::inline programs
