// Excites all steps of a run, waits out what disturbs it, and repeats what was spoilt.
//
// No step is begun unless the analysis attends to the run, its sources are there, nobody has paused
// it, and the generator answers with its output off (one that is set by hand: its operator has
// confirmed that it is off). When one of these fails in a step, the output
// is switched off and the step is broken off; once all is well again the run goes on with the next.
// What neither comes back within `away_limit` nor reports that it is at work ends the run;
// run_outlook.hpp decides what is waited for at all. Pauses are said at once and kept in the
// outcome.
//
// A fault of a device in one step (a setting that the generator refuses, a level that is not
// reached) breaks off that step alone: the run goes on with the others. A step that still fails
// after its last attempt ends the run with its results and is named. A level above its maximum ends
// the run at once.
//
// The next step begins only when the result of one that was broken off has come, or none comes: a
// step of the same frequency could be taken for it.
//
// After the planned steps their results are awaited, and steps that another attempt may improve are
// excited again, one at a time, each after the results of the one before (step_repeats.hpp).
//
// Fails as StepExcitation does, and (no_analysis, no_source, device, no_result) when the run is
// over by run_outlook.hpp or has waited too long. A requested stop is not a failure. Belongs to one
// thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>

#include "services/run/run_environment.hpp"
#include "services/run/run_watch.hpp"
#include "services/run/step_repeats.hpp"

namespace dyncal::inline run {

class StepExcitation;

class StepSequence {
public:
  static constexpr std::chrono::seconds away_limit{
      120}; // for the analysis, a source, the generator
  static constexpr std::chrono::seconds results_limit{25}; // from the last result to the next
  static constexpr std::chrono::seconds missed_limit{8}; // then those that are there come once more

  // Connects the generator, its output off. `watch` and what `environment` names outlive the
  // object.
  [[nodiscard]] static Expected<std::unique_ptr<StepSequence>>
  open(const RunEnvironment& environment, const BenchFile& bench, RunWatch& watch,
       std::shared_ptr<bus::WakeUp> wake_up);
  ~StepSequence();
  StepSequence(const StepSequence&) = delete;
  StepSequence& operator=(const StepSequence&) = delete;

  // Before excite_all(): the results that are there tell which steps were excited, and how often;
  // the one behind them was perhaps broken off when its conductor died.
  void resume();
  [[nodiscard]] Expected<void> excite_all(const std::stop_token& stop);

  [[nodiscard]] bool output_may_be_on() const;
  [[nodiscard]] Expected<bool> switch_off();

private:
  using Instant = bus::Clock::Instant;

  StepSequence(RunWatch& watch, const BenchFile& bench);
  Expected<void> keep_alive();
  Expected<void> excite(std::size_t place, const std::stop_token& stop);
  Expected<void> repeat_steps(const std::stop_token& stop);
  // Returns false when nothing more is to be expected of the analysis.
  Expected<bool> wait_until_evaluated(const std::stop_token& stop);
  Expected<void> wait_until_well(const std::stop_token& stop);
  Expected<void> wait_for_broken_off(const std::stop_token& stop);
  [[nodiscard]] RunOutlook outlook() const;
  [[nodiscard]] std::string waiting_phase(const RunOutlook& outlook) const;
  void try_generator();
  void go_on(Instant since); // after a pause
  // Fails when there are steps whose last attempt had a fault.
  [[nodiscard]] Expected<void> check_faults() const;
  [[nodiscard]] std::size_t place_of(std::uint32_t step) const;

  RunWatch& watch_;
  std::size_t lines_; // steps that are excited at once
  StepRepeats repeats_;
  std::unique_ptr<StepExcitation> excitation_;
  std::optional<RunOutlook> interrupted_by_; // the step that is, or was last, excited
  std::optional<RunOutlook> by_generator_;   // nothing: it answers
  Instant generator_tried_;
  wire::ExcitationState announced_ = wire::EXCITATION_DONE; // of the step that was excited last
  std::map<std::uint32_t, Error> faults_;   // of a device, in the last attempt at a step
  std::optional<std::uint32_t> broken_off_; // and whose result has not been waited for
};

} // namespace dyncal::inline run
