// One source of a run as the analysis sees it: how it has described itself, which session the run
// goes by, what of its samples waits, and what it lacks to be the run's.
//
// A newer description that the run cannot go by makes the source unfit until another one comes.
// Sentences name the source and its bench as people know them; source_streams.hpp asks each source
// of a run the same. Belongs to the run's one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "services/bus/clock.hpp"
#include "services/contract/duplicate_source_detector.hpp"
#include "services/contract/known_sources.hpp"
#include "services/programs/analysis/described_sessions.hpp"
#include "services/programs/analysis/session_writers.hpp"
#include "services/programs/analysis/stream_follower.hpp"
#include "services/programs/analysis/waiting_blocks.hpp"

namespace dyncal::inline programs {

// Why a run is not armed yet.
struct MissingSource {
  std::string sentence;
  bool is_there = false;    // a source that has yet to describe its channels, or to answer
  bool is_starting = false; // that has yet to describe them
};

// Why a run cannot go on now.
struct LostSource {
  std::string message;
  bool may_come_back = true;
  bool is_other_device = false;
};

struct SourceStream {
  using Instant = bus::Clock::Instant;
  using Follower =
      std::variant<StreamFollower<wire::SampleBlock>, StreamFollower<wire::TriggeredRecord>>;
  struct UnfitDescription {
    wire::SourceDescription description;
    std::string why;
    bool is_other_device = false; // whose samples are never the run's
  };
  // How long a source may be silent: since its last block, and since `from`.
  struct Patience {
    Instant from;
    std::chrono::seconds limit;
    bool may_not_end; // before the run does
  };

  std::optional<wire::SourceDescription> description; // as the evaluator knows it
  std::optional<UnfitDescription> unfit{};            // a newer one
  // Of a session that the evaluator is not ready for, or whose description is unfit.
  WaitingBlocks waiting{};
  DescribedSessions described{}; // as the evaluator knows it
  bool is_undescribed = false;   // what came last, and was left out
  Instant waiting_since{};
  std::optional<Follower> follower; // from the first description on
  DuplicateSourceDetector twins;
  SessionWriters writers{};
  std::string second_writer{}; // sentence; empty: there was none
  std::string service{};       // that described it last, host and process; empty: not known
  std::string service_before{};

  [[nodiscard]] bool is_triggered() const;
  [[nodiscard]] bool has_answered() const;
  [[nodiscard]] bool is_unfit(std::uint64_t session) const;
  // This session is the run's.
  void take(const wire::SourceDescription& other);

  [[nodiscard]] bool is_catching_up() const;
  [[nodiscard]] bool lacks_beginning() const;
  // What it sends now does not reach the evaluator.
  [[nodiscard]] bool is_held_up(Instant now) const;
  [[nodiscard]] std::uint64_t recovered() const;

  // `known`: what the bench knows of it; null: nobody has heard of it.
  [[nodiscard]] std::optional<MissingSource> what_is_missing(const std::string& bench,
                                                             const std::string& name,
                                                             const KnownSource* known) const;
  [[nodiscard]] std::optional<LostSource> loss(const std::string& bench, const std::string& name,
                                               Instant now, const Patience& patience) const;
};

} // namespace dyncal::inline programs
