// One run at the analysis service: from the Measurement message over the armed handshake to the
// last result.
//
// Armed means: every source of the recipe has described itself with the channels needed, is not
// silent, and has answered the ARM command in its own sample stream, so commands arrive there and
// samples arrive here (idl/README.md, "The run protocol").
//
// Limits: a run that is not armed within `Arming::limit` is refused with one sentence, which its
// status says from `notice_after` on; a source that is there, but is still starting, or busy with
// other runs, is waited for up to `Arming::present_limit`. A live source that sent nothing for
// `silence_limit`, or has ended, makes it WAITING for up to `patience`, then FAILED. Once the
// excitation is over and nothing was published for `quiet_limit`, or nothing was heard of the run
// for `runner_limit`, it finishes with the results so far. Time in which this process did not work
// itself (stopped, or without the processor) counts for nobody's silence.
//
// A session that begins in the middle of its run (the service was started late, or another one has
// died) asks every source for what it has sent since its answer, and gives the results that the
// other would have: the same samples, the same bits. Until then it is WAITING, so that nothing is
// excited that nobody watches, and who resumes the run learns which of its steps are left. Where a
// source does not have the beginning any more, the run is refused: steps could be taken for others.
// What was announced meanwhile counts when the samples have come, here and after a link was down
// (stream_follower.hpp). Whether steps were announced at all, such a session has not heard: with
// all that was planned, it waits for `announcement_limit` for who excites them, and may excite some
// again.
//
// Who resumes it with another recipe, or while a source is another instrument than the run began
// with, is asked to end (Command ABORT), and the run is left as it is.
//
// One bench, one run: what one run excites, another would take for its own. A run that finds
// another of its bench before it waits for the end of that one, and is refused as soon as that one
// shows that it lives, by its Measurement (every 2 s) or Excitation. A run of which nothing was
// heard for `bench_limit`, and for `listening_time` since the next one came, has died, and is
// ended.
//
// Belongs to the service's one thread. Its results stay readable for late joiners until it is
// destroyed; services/programs/analysis/README.md describes the states.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "idl/dyncal.h"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/programs/analysis/pending_announcements.hpp"
#include "services/programs/analysis/run_conductor.hpp"
#include "services/programs/analysis/run_publisher.hpp"
#include "services/programs/analysis/session_state.hpp"
#include "services/programs/analysis/source_requests.hpp"
#include "services/programs/analysis/source_streams.hpp"

namespace dyncal::inline programs {

// What all runs of a service share; outlives them.
struct AnalysisContext {
  bus::Participant& participant;
  bus::Clock& clock;
  std::shared_ptr<bus::WakeUp> wake_up;
  AnalysisIdentity identity;
  std::shared_ptr<LeftOutMessages> left_out = std::make_shared<LeftOutMessages>();
};

class RunSession {
public:
  static constexpr std::chrono::seconds notice_after{2};
  static constexpr std::chrono::seconds bench_limit{4};
  static constexpr std::chrono::milliseconds listening_time{2500};
  static constexpr std::chrono::seconds silence_limit{5};
  static constexpr std::chrono::seconds patience{120};
  static constexpr std::chrono::seconds quiet_limit{8};
  static constexpr std::chrono::seconds announcement_limit{20};
  static constexpr std::chrono::seconds runner_limit{135}; // it may wait for `patience`, too

  // Asks its sources by `requests`, which the runs of a bench share. Fails (network) as writers do.
  // A recipe that cannot be evaluated makes a session that is refused.
  [[nodiscard]] static Expected<std::unique_ptr<RunSession>>
  create(const AnalysisContext& context, const wire::Measurement& measurement,
         std::shared_ptr<SourceRequests> requests,
         SourceStreams::Begin begin = SourceStreams::Begin::with_answer);

  [[nodiscard]] bool armed() const { return arm_state() == wire::ARM_ARMED; }
  // As it came last.
  [[nodiscard]] const wire::Measurement& measurement() const { return measurement_; }
  [[nodiscard]] bool finished() const { return is<Ended>(); }

  [[nodiscard]] const std::shared_ptr<SourceRequests>& requests() const { return requests_; }
  [[nodiscard]] wire::ArmState arm_state() const { return arm_of(state_); }
  // Whether its recipe names this source; false once it is finished.
  [[nodiscard]] bool uses(const std::string& source) const {
    return streams_ && streams_->contains(source);
  }

  void update(const wire::Measurement& measurement);
  void announce(const wire::Excitation& excitation);
  // Does what is due: takes samples, asks sources to answer, evaluates, publishes. `before`: the
  // run before it on its bench, null if that one is finished.
  void work(const KnownSources& sources, RunSession* before = nullptr);

private:
  using Instant = bus::Clock::Instant;

  RunSession(const AnalysisContext& context, const wire::Measurement& measurement,
             std::shared_ptr<SourceRequests> requests, RunPublisher publisher);
  void prepare(const wire::Measurement& measurement, SourceStreams::Begin begin);
  void discount_own_stall(Instant now);
  void take_samples(const KnownSources& sources, Instant now);
  void catch_up(Instant now);
  void wait_for_bench(RunSession& before, Instant now);
  // Ends this run for the next one.
  void give_way_to(const std::string& next);
  void arm(const KnownSources& sources, Instant now);
  void watch_sources(Instant now);
  void watch_measurement();
  void end_takeover(Instant now);
  void evaluate(Instant now);
  void finish();
  void end_overdue(Instant now);
  void end_with_what_came(bool aborted);
  [[nodiscard]] bool is_played_to_its_end(Instant now) const;
  void enter(SessionState state, std::string message);
  void publish();
  void begin_arming_again(Instant now);
  [[nodiscard]] std::optional<LostSource> late_steps(Instant now) const;
  void wait_for_source(LostSource lost, Instant now);
  void refuse(std::string message);
  [[nodiscard]] bool lacks_samples(Instant now) const;
  template <class State>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<State>(state_);
  }
  [[nodiscard]] bool excitation_over() const {
    return measurement_.state() == wire::MEASUREMENT_DONE ||
           measurement_.state() == wire::MEASUREMENT_ABORTED;
  }

  bus::Participant& participant_;
  bus::Clock& clock_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::shared_ptr<LeftOutMessages> left_out_;
  std::string bench_;
  std::string run_;
  RunConductor conductor_;
  std::shared_ptr<SourceRequests> requests_;
  RunPublisher publisher_;
  wire::Measurement measurement_;
  bool excited_by_steps_ = false; // by a generator; files and excitation by hand announce no steps
  std::unique_ptr<RunEvaluator> evaluator_; // until the run is finished or refused
  std::optional<SourceStreams> streams_;    // as long
  PendingAnnouncements announced_;
  Instant created_;
  SessionState state_;
  std::string message_; // of the state, for people
  Instant last_heard_of_run_;
  Instant last_progress_;
  Instant worked_;         // when work() was called last
  Instant present_since_;  // since when it has been called without a break
  std::uint64_t come_ = 0; // messages that had to be asked for, and steps handed out
  Instant next_command_;
  Instant next_status_;
};

} // namespace dyncal::inline programs
