// The sources of one run as the analysis sees them: who has described itself, who has answered, and
// what each has sent; their samples go to the run's evaluator.
//
// Samples of a source count from its answer on: a block or record that names the run
// (idl/README.md, "The run protocol"). What comes before is not of this run. Readers are opened
// when a source's kind is known, one a topic. Belongs to the run's one thread.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/analysis/known_sources.hpp"
#include "services/analysis/twin_watch.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::services {

class SourceStreams {
public:
  using Instant = bus::Clock::Instant;

  // `participant` outlives the object. `sources` are those of the recipe.
  SourceStreams(bus::Participant& participant, std::shared_ptr<bus::WakeUp> wake_up,
                std::string bench, std::string run, const std::vector<std::string>& sources);

  // Hands new descriptions to the evaluator. Fails as RunEvaluator::describe() and readers do.
  [[nodiscard]] Expected<void> take_descriptions(const KnownSources& known,
                                                 RunEvaluator& evaluator);
  // Hands what has come of sources that have answered to the evaluator.
  void take_samples(Instant now, RunEvaluator& evaluator);
  void close_readers();

  // Sources that have described themselves and are to be asked for an answer.
  [[nodiscard]] std::vector<std::string> unanswered() const;
  // One sentence about the first source that keeps the run from being armed; empty if none does.
  [[nodiscard]] std::string what_is_missing(const KnownSources& known) const;
  // One sentence about the first source without which the run cannot go on: it sent nothing for
  // `silence_limit` since its last block and since `watched_from`, or, if `may_not_end`, it ended.
  [[nodiscard]] std::optional<std::string> lost_source(Instant now, Instant watched_from,
                                                       std::chrono::seconds silence_limit,
                                                       bool may_not_end) const;

private:
  struct Stream {
    std::optional<wire::SourceDescription> description; // as the evaluator knows it
    bool described = false;
    bool answered = false;
    bool ended = false;
    bool triggered = false; // sends a record for each shot, and may be silent between them
    Instant last_sent;
    TwinWatch twins;
  };

  [[nodiscard]] std::string two_send_as(const std::string& source) const;
  [[nodiscard]] Expected<void> describe(Stream& stream, const wire::SourceDescription& description,
                                        RunEvaluator& evaluator);
  void hand_over(const std::string& source, const wire::SampleBlock& block,
                 RunEvaluator& evaluator) const;
  void hand_over(const std::string& source, const wire::TriggeredRecord& record,
                 RunEvaluator& evaluator) const;
  template <class Message>
  [[nodiscard]] Expected<void>
  open_reader(std::map<wire::SourceKind, bus::Reader<Message>>& readers, wire::SourceKind kind);
  template <class Message>
  void take(bus::Reader<Message>& reader, Instant now, RunEvaluator& evaluator);

  bus::Participant& participant_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::string bench_;
  std::string run_;
  std::map<std::string, Stream> streams_;
  std::map<wire::SourceKind, bus::Reader<wire::SampleBlock>> block_readers_;
  std::map<wire::SourceKind, bus::Reader<wire::TriggeredRecord>> record_readers_;
};

} // namespace dyncal::services
