// Conducts one run on a bench: publishes the recipe, waits until the analysis is armed, excites
// step by step, collects what is published.
//
// Order of messages: idl/README.md, "The run protocol"; services/run/step_excitation.hpp excites
// the steps. The generator's output is off on every way out: end, error, stop. Fails: no_analysis
// (nobody answers, or the recipe is refused), no_source, device (generator), network, no_result. A
// stop is no failure: the outcome says `interrupted` and holds what was measured. Belongs to one
// thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "analysis/instrument/adc_calibration.hpp"
#include "idl/dyncal.h"
#include "services/bench/bench_file.hpp"
#include "services/bus/bus.hpp"
#include "services/run/step_excitation.hpp"

namespace dyncal::services {

struct RunProgress {
  std::size_t step = 0; // 1..steps; 0 before the first
  std::size_t steps = 0;
  std::string frequency_hz;
  std::string phase;   // "waiting for the analysis", "settling", "measuring", ...
  std::string request; // to the operator; "" for none
  std::size_t results = 0;
  std::optional<double> seconds_left; // of the host's clock
};

struct RunOutcome {
  wire::Measurement measurement;
  std::string analysis_dds;
  std::vector<wire::CalibrationResult> results; // in the order of steps, then as published
  std::vector<wire::TransferFunction> transfer_functions;
  std::vector<wire::SampleClockReport> clock_reports;
  bool interrupted = false;
  std::string problem; // why the run ended early, "" when it did not
};

class RunController {
public:
  using ShowProgress = std::function<void(const RunProgress&)>;

  RunController(bus::Participant& participant, const BenchFile& bench, std::string run,
                ShowProgress show_progress);

  [[nodiscard]] Expected<RunOutcome>
  conduct(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
          const std::stop_token& stop);

private:
  using Clock = std::chrono::steady_clock;

  struct Endpoints {
    bus::Writer<wire::Measurement> measurement;
    bus::Writer<wire::Excitation> excitation;
    bus::Reader<wire::ServiceStatus> status;
    bus::Reader<wire::CalibrationResult> results;
    bus::Reader<wire::TransferFunction> transfer_functions;
    bus::Reader<wire::SampleClockReport> clock_reports;
  };

  Expected<void> open_endpoints();
  Expected<void> open_excitation();
  Expected<void> wait_until_armed(const std::stop_token& stop);
  Expected<void> excite(const std::stop_token& stop);
  // Keeps the run alive on the network; fails when the analysis, or a source that it watches, is
  // lost.
  Expected<void> attend();
  Expected<void> wait_for_results(const std::stop_token& stop);
  void announce(const wire::PlannedStep& step, wire::ExcitationState state);
  void set_state(wire::MeasurementState state);
  void keep_alive();
  void take_messages();
  void show(const std::string& phase, const std::string& request = "");
  [[nodiscard]] bool everything_has_come() const;

  bus::Participant& participant_;
  const BenchFile& bench_;
  std::string run_;
  ShowProgress show_progress_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::unique_ptr<Endpoints> endpoints_;
  RunOutcome outcome_;
  std::optional<wire::ServiceStatus> analysis_;
  Clock::time_point analysis_heard_;
  Clock::time_point last_alive_;
  std::size_t step_ = 0;
  std::int64_t window_begin_utc_ns_ = 0;
  Clock::time_point first_step_began_;
  std::unique_ptr<StepExcitation>
      excitation_; // last: its end may ask the operator to switch the output off
};

} // namespace dyncal::services
