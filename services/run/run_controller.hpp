// Conducts one run on a bench: publishes the recipe, waits until the analysis is armed, excites
// step by step, collects what is published.
//
// Order of messages: idl/README.md, "The run protocol". Its states have the classes arming_wait.hpp
// or resume_wait.hpp, step_sequence.hpp, which excites the steps, waits for what is away for a
// while, and repeats what was spoilt, and results_wait.hpp. The generator's output is off on every
// way out: end, error, stop.
//
// Fails: no_analysis (nobody answers, or the run is not armed in time), no_source (the analysis
// refuses the run), device (generator), network, interrupted (before the first step). Later there
// are no failures: the outcome holds what was measured and gives the reason why the run ended
// early. Belongs to one thread.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "analysis/instrument/adc_calibration.hpp"
#include "idl/dyncal.h"
#include "services/bench/file/bench_file.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/run/run_environment.hpp"
#include "services/run/run_keeping.hpp"
#include "services/run/run_progress.hpp"

namespace dyncal::inline run {

class RunWatch;
class StepSequence;

class RunController {
public:
  RunController(bus::Participant& participant, const BenchFile& bench, std::string run,
                ShowProgress show_progress)
      : RunController(RunEnvironment{.participant = participant}, bench, std::move(run),
                      std::move(show_progress)) {}
  RunController(RunEnvironment environment, const BenchFile& bench, std::string run,
                ShowProgress show_progress);
  ~RunController();
  RunController(RunController&&) noexcept;

  // Before conduct() or resume().
  void set_keeping(RunKeeping keeping) { keeping_ = std::move(keeping); }

  [[nodiscard]] Expected<RunOutcome>
  conduct(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
          const std::stop_token& stop);
  // Goes on with the run of this name, whose conductor has died: steps that have their results are
  // not excited again. A run that has ended at the analysis is not gone on with: what it gave is
  // collected, and the steps that it lacks are the outcome's problem. Fails too where no analysis
  // holds the run any more (no_analysis), where it was made with another bench file, or with a file
  // that this one names and that has changed (bad_file), where a source is another instrument now
  // (no_source), and for recorded files (bad_argument). REQUIRES: nobody else conducts it.
  [[nodiscard]] Expected<RunOutcome>
  resume(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
         const std::stop_token& stop);

  // An analysis has spoken of the run.
  [[nodiscard]] bool has_heard_analysis() const;

private:
  using Instant = bus::Clock::Instant;

  Expected<void> open(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration);
  Expected<void> open_sequence();
  Expected<void> check_before_first_step(const std::stop_token& stop);
  Expected<RunOutcome> excite_and_collect(const std::stop_token& stop);
  Expected<RunOutcome> collect_of_ended_run(const std::stop_token& stop);
  void settle_means(bool all_results_came);
  [[nodiscard]] std::string name() const; // of the run, for people
  [[nodiscard]] bool has_ended_at_analysis() const;
  // What an analysis that has ended the run does not give; empty where it gives all.
  [[nodiscard]] std::string lack_of_ended_run() const;
  [[nodiscard]] wire::MeasurementState final_state(bool excited) const;

  RunEnvironment environment_;
  bus::Clock& clock_;
  const BenchFile& bench_;
  std::string run_;
  ShowProgress show_progress_;
  RunKeeping keeping_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  RunOutcome outcome_;
  std::unique_ptr<RunWatch> watch_;
  // Nothing when recorded files take its place. Last: its end may ask the operator to switch the
  // output off.
  std::unique_ptr<StepSequence> sequence_;
};

} // namespace dyncal::inline run
