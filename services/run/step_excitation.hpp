// Excites the steps of a run one after the other: generator, level, durations, shots.
//
// A step holds the output on for its planned settling, its duration and a margin in which the
// analysis finds the edges of the steady part, then off for a moment, which separates it from the
// next. Durations are in bench time (the generator's clock) and begin when what was set is in
// effect: with a generator set by hand, when the operator has confirmed.
//
// With a level tolerance the voltage follows what the reference shows
// (drivers/generator/level_control.hpp) within the planned settling
// (services/run/level_settling.hpp). Of a multi-sine (multisine_drive.hpp) a first excitation with
// half the levels shows what each line needs; it ends as one that was broken off, and the step is
// to be excited again.
//
// The output is off whenever excite() has returned, unless output_may_be_on(): then the generator
// or its operator has not confirmed it, and switch_off() tries again. A guard switches it off when
// the program is killed, and goes on trying when the object is destroyed before it is known to be
// off. Fails: bad_argument (a level above a limit, before anything is excited), device (generator,
// exciter), and as `keep_alive` does. A requested stop is not a failure. Belongs to one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "drivers/generator/level_control.hpp"
#include "idl/dyncal.h"
#include "services/bench/file/bench_file.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/run/driven_generator.hpp"
#include "services/run/multisine_drive.hpp"
#include "services/run/run_environment.hpp"
#include "services/run/shot_counter.hpp"

namespace dyncal::inline run {

class LevelMeter;

// What the run does while a step is excited.
struct StepHooks {
  std::function<void(const wire::PlannedStep&, std::uint32_t attempt, wire::ExcitationState)>
      announce;
  std::function<void(const std::string& phase)> show;
  WaitHooks wait;
};

class StepExcitation {
public:
  // Connects the generator, its output off.
  [[nodiscard]] static Expected<std::unique_ptr<StepExcitation>>
  open(const RunEnvironment& environment, const BenchFile& bench,
       const wire::Measurement& measurement, std::shared_ptr<bus::WakeUp> wake_up, StepHooks hooks);

  ~StepExcitation();
  StepExcitation(const StepExcitation&) = delete;
  StepExcitation& operator=(const StepExcitation&) = delete;

  // Before the first step and after the last.
  [[nodiscard]] Expected<void> begin();
  void end();
  // Every step ends with EXCITATION_DONE, or else EXCITATION_ABORTED.
  [[nodiscard]] Expected<void> excite(const wire::PlannedStep& step, std::uint32_t attempt,
                                      const std::stop_token& stop);

  // The last excitation was one that shows the levels of a multi-sine's lines.
  [[nodiscard]] bool was_level_record() const { return was_level_record_; }
  [[nodiscard]] bool output_may_be_on() const { return generator_->output_may_be_on(); }
  [[nodiscard]] bool generator_is_away() const { return generator_->is_away(); }
  // What failed in the last step was a matter of that step: a setting that the generator refused, a
  // level that was not reached. Another attempt may be without it. Never so where a limit of the
  // level would be passed or was, or a person sets the generator.
  [[nodiscard]] bool fault_may_pass() const { return generator_->fault_may_pass(); }
  [[nodiscard]] Expected<bool> switch_off() { return generator_->switch_off(); }

private:
  StepExcitation(const RunEnvironment& environment, const BenchFile& bench, std::string run,
                 std::shared_ptr<bus::WakeUp> wake_up, StepHooks hooks);

  Expected<void> check_levels(const wire::Measurement& measurement) const;
  void announce(const wire::PlannedStep& step, wire::ExcitationState state) {
    hooks_.announce(step, attempt_, state);
  }
  // The samples that have come by then, for the level meter, if there is one.
  void take_reference(double now_s);
  Expected<void> hold_step(const wire::PlannedStep& step, const std::stop_token& stop);
  // Sets frequency and voltage, or the waveform of this part of a multi-sine's levels, and waits
  // until the output is on; see below.
  Expected<double> switch_on(const wire::PlannedStep& step, double voltage_v);
  Expected<double> switch_on_multisine(const wire::PlannedStep& step, double part);
  Expected<double> switch_on_as_set(const wire::PlannedStep& step, drivers::Expected<void> set);
  Expected<double> begin_step(const wire::PlannedStep& step, const std::stop_token& stop);
  Expected<void> record_levels(const wire::PlannedStep& step, const std::stop_token& stop);
  Expected<double> switch_on_to_level(const wire::PlannedStep& step, const std::stop_token& stop);
  // Before the output is on; listens before the first step after begin().
  Expected<void> refuse_hum(const wire::PlannedStep& step, const std::stop_token& stop);
  Expected<void> listen();
  Expected<std::optional<double>> measure_level(double changed_s, double deadline_s,
                                                const std::stop_token& stop);
  Expected<void> hold_until_shots_are_taken(const std::stop_token& stop);
  [[nodiscard]] drivers::generator::LevelTarget target_of(const wire::PlannedStep& step) const;

  bus::Participant& participant_;
  bus::Clock& clock_;
  const BenchFile& bench_;
  std::string run_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  StepHooks hooks_;
  std::unique_ptr<DrivenGenerator> generator_; // from open() on
  bool was_level_record_ = false;
  std::optional<MultisineDrive> multisine_;
  wire::PlannedStep step_;                        // that is, or was last, excited
  std::uint32_t attempt_ = 1;                     // of the step that is excited
  std::unique_ptr<LevelMeter> meter_;             // with a level tolerance, between begin and end
  std::map<std::string, double> known_responses_; // m/s^2 per V by frequency, from earlier steps
  // m/s^2 by frequency that the reference shows while nothing is excited, once it was listened to.
  std::optional<std::map<std::string, double>> quiet_levels_;
  std::optional<ShotCounter> shots_; // series time stamping only
};

} // namespace dyncal::inline run
