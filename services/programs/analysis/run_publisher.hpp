// What the analysis service publishes about one run: its status, and results, with a count of each
// kind for the status.
//
// Results stay readable for late joiners as long as the object lives. A message that the network
// does not take within 10 s is logged and given up: the next status comes anyway, and a result that
// is missing shows against the counts of the status.
//
// At the end of a run, and where one is taken over, its results come all at once: some megabytes,
// where a socket of Linux holds a tenth of one. What it loses is repeated, again too much at once,
// and the next status with it. So results are queued, no more than the run has, and go out a few at
// a time, after those before were acknowledged; who does not acknowledge for 10 s is not waited for
// until it does. Belongs to the run's one thread, which a full writer holds up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::inline programs {

// The program that analyses.
struct AnalysisIdentity {
  std::string service; // key of ServiceStatus
  std::string host;
  std::uint32_t process_id = 0;
  std::string dds; // to_string(Vendor)
};

// What a ServiceStatus reports of a run.
struct RunState {
  wire::ArmState arm = wire::ARM_WAITING;
  wire::HealthState health = wire::HEALTH_OK;
  std::string message;
  // Of the run, so that its conductor knows its analysis.
  std::string conductor = {};
  std::string recipe_sha256 = {};
};

class RunPublisher {
public:
  static constexpr std::size_t results_at_once = 8;
  static constexpr std::chrono::seconds acknowledgment_limit{10};

  // `participant` need not outlive the object, `clock` must. Fails (network) as writers do.
  [[nodiscard]] static Expected<RunPublisher> open(bus::Participant& participant, bus::Clock& clock,
                                                   AnalysisIdentity identity, std::string bench,
                                                   std::string run);

  void publish(const RunState& state);
  // Queues it behind what waits, and hands over what may go.
  void publish(const Recipe& recipe, const EvaluationOutput& output);
  // Whether nothing waits any more.
  [[nodiscard]] bool has_published_all() const {
    return waiting_.empty() && !comes_once_more_ && functions_waiting_.empty() &&
           reports_waiting_.empty();
  }
  [[nodiscard]] std::uint64_t results() const { return results_; }

private:
  struct Writers {
    bus::Writer<wire::ServiceStatus> status;
    bus::Writer<wire::CalibrationResult> result;
    bus::Writer<wire::TransferFunction> transfer_function;
    bus::Writer<wire::SampleClockReport> clock_report;
  };

  RunPublisher(bus::Clock& clock, AnalysisIdentity identity, std::string bench, std::string run,
               Writers writers)
      : clock_(&clock), identity_(std::move(identity)), bench_(std::move(bench)),
        run_(std::move(run)), writers_(std::move(writers)) {}
  struct WaitingResult {
    wire::CalibrationResult message;
    bool counts = false; // for the status; those that come once more do not
  };

  void queue(const Recipe& recipe, const EvaluationOutput& output);
  void hand_over();
  [[nodiscard]] bool are_acknowledged(bus::Clock::Instant turn_ends);
  template <class Message>
  void write(bus::Writer<Message>& writer, const Message& message);

  bus::Clock* clock_;
  AnalysisIdentity identity_;
  std::string bench_;
  std::string run_;
  Writers writers_;
  std::deque<WaitingResult> waiting_;
  std::vector<wire::TransferFunction> functions_waiting_; // behind all results
  std::vector<wire::SampleClockReport> reports_waiting_;
  std::size_t unacknowledged_ = 0; // results at most
  bool comes_once_more_ = false;   // a result that was sent before, until it is acknowledged
  bool is_unheard_ = false;        // somebody has not acknowledged within the limit
  bus::Clock::Instant waits_since_{};
  std::uint64_t results_ = 0;
  std::uint64_t transfer_functions_ = 0;
  std::uint64_t clock_reports_ = 0;
};

} // namespace dyncal::inline programs
