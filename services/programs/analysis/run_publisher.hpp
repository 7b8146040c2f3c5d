// What the analysis service publishes about one run: its status, and results, with a count of each
// kind for the status.
//
// Results stay readable for late joiners as long as the object lives. A message that the network
// does not take within 10 s is logged and given up: the next status comes anyway, and a result that
// is missing shows against the counts of the status. Belongs to the run's one thread, which a full
// writer holds up.
#pragma once

#include <cstdint>
#include <string>

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
  // `participant` need not outlive the object, `clock` must. Fails (network) as writers do.
  [[nodiscard]] static Expected<RunPublisher> open(bus::Participant& participant, bus::Clock& clock,
                                                   AnalysisIdentity identity, std::string bench,
                                                   std::string run);

  void publish(const RunState& state);
  void publish(const Recipe& recipe, const EvaluationOutput& output);
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
  template <class Message>
  void write(bus::Writer<Message>& writer, const Message& message);

  bus::Clock* clock_;
  AnalysisIdentity identity_;
  std::string bench_;
  std::string run_;
  Writers writers_;
  std::uint64_t results_ = 0;
  std::uint64_t transfer_functions_ = 0;
  std::uint64_t clock_reports_ = 0;
};

} // namespace dyncal::inline programs
