// One run at the analysis service: from the Measurement message over the armed handshake to the
// last result.
//
// Armed means: every source of the recipe has described itself with the channels needed, is not
// silent, and has answered the ARM command in its own sample stream, so commands arrive there and
// samples arrive here (idl/README.md, "The run protocol").
//
// Limits: a run that is not armed within `arm_limit` is refused with one sentence. While it is
// RUNNING, a live source that sent nothing for `silence_limit` fails it. Once the excitation is
// over and nothing was published for `quiet_limit`, or nothing was heard of the run for
// `runner_limit`, it ends with what there is.
//
// One bench, one run: what one run excites, another would take for its own. A run that finds
// another of its bench before it waits for the end of that one for `bench_limit`, and is refused as
// soon as that one shows that it lives. A run of which nothing was heard for so long has died, and
// is ended.
//
// Belongs to the service's one thread. Its results stay readable for late joiners until it is
// destroyed; services/analysis/README.md describes the states.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "idl/dyncal.h"
#include "services/analysis/run_publisher.hpp"
#include "services/analysis/source_streams.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::services {

// What all runs of a service share; outlives them.
struct AnalysisContext {
  bus::Participant& participant;
  bus::Clock& clock;
  std::shared_ptr<bus::WakeUp> wake_up;
  AnalysisIdentity identity;
};

class RunSession {
public:
  static constexpr std::chrono::seconds arm_limit{6};
  static constexpr std::chrono::seconds bench_limit{5};
  static constexpr std::chrono::seconds silence_limit{5};
  static constexpr std::chrono::seconds quiet_limit{8};
  static constexpr std::chrono::seconds runner_limit{15};

  // Fails (network) as writers do. A recipe that cannot be evaluated makes a session that is
  // refused.
  [[nodiscard]] static Expected<std::unique_ptr<RunSession>>
  create(const AnalysisContext& context, const wire::Measurement& measurement);

  [[nodiscard]] bool finished() const {
    return status_.arm == wire::ARM_FINISHED || status_.arm == wire::ARM_REFUSED;
  }

  void update(const wire::Measurement& measurement);
  void announce(const wire::Excitation& excitation);
  // Does what is due: takes samples, asks sources to answer, evaluates, publishes. `before`: the
  // run before it on its bench, null if that one is finished.
  void work(const KnownSources& sources, RunSession* before = nullptr);

private:
  using Instant = bus::Clock::Instant;

  RunSession(const AnalysisContext& context, const wire::Measurement& measurement,
             RunPublisher publisher);
  void prepare(const wire::Measurement& measurement);
  void take_samples(const KnownSources& sources, Instant now);
  void wait_for_bench(RunSession& before, Instant now);
  // Ends this run for the next one.
  void give_way_to(const std::string& next);
  void arm(const KnownSources& sources, Instant now);
  void watch_sources(Instant now);
  void watch_level();
  void evaluate(Instant now);
  void finish();
  void end_overdue(Instant now);
  void report_failure(std::string message);
  void refuse(std::string message);
  [[nodiscard]] bool excitation_over() const {
    return measurement_ == wire::MEASUREMENT_DONE || measurement_ == wire::MEASUREMENT_ABORTED;
  }

  bus::Participant& participant_;
  bus::Clock& clock_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::string bench_;
  std::string run_;
  std::string conductor_;
  RunPublisher publisher_;
  RunState status_;
  wire::MeasurementState measurement_;
  bool excited_by_steps_ = false; // by a generator; files and excitation by hand announce no steps
  std::unique_ptr<RunEvaluator> evaluator_; // until the run is finished or refused
  std::optional<SourceStreams> streams_;    // as long
  Instant created_;
  Instant arms_since_; // since when it has the bench to itself
  Instant last_heard_of_run_;
  Instant last_progress_;
  Instant next_command_;
  Instant next_status_;
};

} // namespace dyncal::services
