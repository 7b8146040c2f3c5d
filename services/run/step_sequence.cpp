#include "services/run/step_sequence.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "services/evaluation/result/run_pause.hpp"
#include "services/run/step_excitation.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using Kind = RunOutlook::Kind;

constexpr auto broken_off_limit = 10s;    // for the result of a step that was broken off
constexpr auto generator_interval = 1s;   // between two attempts to reach it
constexpr auto last_result_quiet = 300ms; // then all results of a step have come

// Of the steps that are excited; a multi-sine's is its first line.
std::vector<std::uint32_t> numbers_of(const wire::Measurement& measurement, std::size_t lines) {
  std::vector<std::uint32_t> numbers;
  for (std::size_t place = 0; place < measurement.steps().size(); place += lines) {
    numbers.push_back(measurement.steps()[place].step());
  }
  return numbers;
}

} // namespace

StepSequence::StepSequence(RunWatch& watch, const BenchFile& bench)
    : watch_(watch), lines_(watch.outcome().recipe->lines_at_once()),
      repeats_(numbers_of(watch.measurement(), lines_), bench.excitation.attempts) {}

StepSequence::~StepSequence() = default;

bool StepSequence::output_may_be_on() const {
  return excitation_->output_may_be_on();
}

Expected<bool> StepSequence::switch_off() {
  return excitation_->switch_off();
}

Expected<std::unique_ptr<StepSequence>> StepSequence::open(const RunEnvironment& environment,
                                                           const BenchFile& bench, RunWatch& watch,
                                                           std::shared_ptr<bus::WakeUp> wake_up) {
  std::unique_ptr<StepSequence> sequence(new StepSequence(watch, bench));
  auto excitation = StepExcitation::open(
      environment, bench, watch.measurement(), std::move(wake_up),
      {.announce =
           [self = sequence.get()](const wire::PlannedStep& step, std::uint32_t attempt,
                                   wire::ExcitationState state) {
             self->announced_ = state;
             self->watch_.announce(step, attempt, state,
                                   self->excitation_ && self->excitation_->output_may_be_on());
           },
       .show = [&watch](const std::string& phase) { watch.show(phase); },
       .wait = {.ask = [&watch](const std::string& request) { watch.ask(request); },
                .look = [&watch] { watch.look_without_hold(); },
                .hold = [&watch] { watch.look(); },
                .keep_alive = [self = sequence.get()] { return self->keep_alive(); }}});
  DYNCAL_TRY(excitation);
  sequence->excitation_ = std::move(*excitation);
  return sequence;
}

void StepSequence::resume() {
  bool all_so_far = true;
  for (std::size_t place = 0; place < watch_.measurement().steps().size(); place += lines_) {
    const wire::PlannedStep& step = watch_.measurement().steps()[place];
    std::uint32_t attempts = 0;
    for (const StepResult& result : watch_.outcome().results) {
      attempts = result.step == step.step() ? std::max(attempts, result.attempt) : attempts;
    }
    for (std::uint32_t attempt = 0; attempt < attempts; ++attempt) {
      repeats_.begin(step.step());
    }
    if (attempts == 0 && std::exchange(all_so_far, false)) {
      watch_.announce(step, repeats_.begin(step.step()), wire::EXCITATION_ABORTED);
      repeats_.broken_off(step.step());
      broken_off_ = step.step();
    }
  }
}

Expected<void> StepSequence::excite_all(const std::stop_token& stop) {
  Expected<void> excited = excitation_->begin();
  const std::size_t steps = watch_.measurement().steps().size();
  for (std::size_t place = 0; place < steps && excited && !stop.stop_requested(); place += lines_) {
    if (repeats_.attempts_of(watch_.measurement().steps()[place].step()) == 0) {
      excited = excite(place, stop);
    }
  }
  excitation_->end();
  return excited.and_then([&] { return repeat_steps(stop); }).and_then([&] {
    return stop.stop_requested() ? Expected<void>{} : check_faults();
  });
}

Expected<void> StepSequence::check_faults() const {
  if (faults_.empty()) {
    return {};
  }
  const auto& [step, fault] = *faults_.begin();
  const std::size_t others = faults_.size() - 1;
  return fail(
      fault.code,
      fmt::format("{} (attempts: {}){}", fault.message, repeats_.attempts_of(step),
                  others == 0 ? "" : fmt::format("; steps that failed as well: {}", others)));
}

// None against a table: its rows would not tell the second excitation of a step from the first.
Expected<void> StepSequence::repeat_steps(const std::stop_token& stop) {
  while (watch_.measurement().reference_table().empty() && !stop.stop_requested()) {
    DYNCAL_TRY(const auto evaluated, wait_until_evaluated(stop));
    const auto repeat =
        evaluated ? repeats_.next(watch_.outcome().results) : std::optional<StepRepeat>{};
    if (!repeat || stop.stop_requested()) {
      return {};
    }
    watch_.notice(fmt::format("step {} is excited again, attempt {}: {}", repeat->step,
                              repeats_.attempts_of(repeat->step) + 1, repeat->reason));
    Expected<void> excited =
        excitation_->begin().and_then([&] { return excite(place_of(repeat->step), stop); });
    excitation_->end();
    if (!excited) {
      return excited;
    }
  }
  return {};
}

std::size_t StepSequence::place_of(std::uint32_t step) const {
  const auto& steps = watch_.measurement().steps();
  const auto found =
      std::find_if(steps.begin(), steps.end(), [&](const auto& one) { return one.step() == step; });
  return static_cast<std::size_t>(found - steps.begin()) / lines_ * lines_;
}

Expected<void> StepSequence::excite(std::size_t place, const std::stop_token& stop) {
  Expected<void> ready = wait_until_well(stop);
  if (ready && broken_off_) {
    ready = wait_for_broken_off(stop).and_then([&] { return wait_until_well(stop); });
  }
  if (!ready || stop.stop_requested()) {
    return ready;
  }
  const wire::PlannedStep& step = watch_.measurement().steps()[place];
  const std::uint32_t attempt = repeats_.begin(step.step());
  watch_.show_step(place + 1, attempt);
  interrupted_by_.reset();
  faults_.erase(step.step());
  auto excited = excitation_->excite(step, attempt, stop);
  bool fault = false;
  if (announced_ != wire::EXCITATION_DONE) {
    repeats_.broken_off(step.step());
    broken_off_ = step.step();
    fault = !excited && excitation_->fault_may_pass();
    if (excited && excitation_->was_level_record()) {
      repeats_.ask_for(step.step());
      watch_.notice("the levels of all lines are set; this excitation is made again");
    }
  }
  if (fault) {
    faults_.insert_or_assign(step.step(), excited.error());
    watch_.notice(excited.error().message + "; the step is broken off, the run goes on");
  }
  if (!excited && excitation_->generator_is_away()) {
    by_generator_ = RunOutlook{Kind::waits, excited.error()};
  }
  const bool goes_on =
      fault || by_generator_ || (interrupted_by_ && interrupted_by_->kind != Kind::over);
  return goes_on ? Expected<void>{} : excited; // the next step waits until all is well
}

// In a step: fails when its excitation must end.
Expected<void> StepSequence::keep_alive() {
  watch_.look();
  for (const std::uint32_t step : watch_.commands().take_repeats()) {
    repeats_.ask_for(watch_.measurement().steps()[place_of(step)].step());
  }
  const RunOutlook now = watch_.outlook();
  if (now.kind == Kind::well) {
    return {};
  }
  interrupted_by_ = now;
  return fail(now.reason);
}

RunOutlook StepSequence::outlook() const {
  RunOutlook by_others = watch_.outlook();
  if (by_others.kind != Kind::over && by_generator_) {
    return *by_generator_;
  }
  if (by_others.kind == Kind::well && excitation_->output_may_be_on()) {
    return {Kind::paused,
            {ErrorCode::device, "the operator has to confirm that the output is off"}};
  }
  return by_others;
}

std::string StepSequence::waiting_phase(const RunOutlook& outlook) const {
  const char* output =
      excitation_->output_may_be_on()
          ? "THE OUTPUT OF THE GENERATOR MAY BE ON, switch it off by hand if you can"
          : "the output is off";
  if (outlook.kind == Kind::paused) {
    return fmt::format("{} ({})", outlook.reason.message, output);
  }
  const char* awaited = outlook.reason.code == ErrorCode::no_analysis ? "it or another" : "it";
  return fmt::format("{}; waiting for {} up to {} s ({})", outlook.reason.message, awaited,
                     away_limit.count(), output);
}

Expected<void> StepSequence::wait_until_well(const std::stop_token& stop) {
  watch_.look();
  RunOutlook now = outlook();
  if (now.kind == Kind::well) {
    return {};
  }
  excitation_->end();
  if (now.kind == Kind::over) {
    return fail(now.reason);
  }
  const Instant began = watch_.clock().now();
  note_pause(watch_.outcome().pauses, watch_.clock().utc_now_ns(), waiting_phase(now));
  bool waits = false; // for something that is away, since then
  Instant since;
  std::size_t signs_before = watch_.signs_of_work();
  while (now.kind != Kind::well && now.kind != Kind::over && !stop.stop_requested()) {
    if (now.kind == Kind::waits && !waits) {
      since = watch_.analysis_heard();
    }
    waits = now.kind == Kind::waits;
    if (watch_.signs_of_work() != std::exchange(signs_before, watch_.signs_of_work())) {
      since = watch_.clock().now();
    }
    if (waits && watch_.clock().now() - since > away_limit) {
      go_on(began);
      return fail(now.reason);
    }
    const std::string phase = waiting_phase(now);
    if (watch_.measurement().message() != phase) { // as others are told, for recordings
      if (!is_same_reason(watch_.measurement().message(), phase)) {
        watch_.notice(phase);
      }
      note_pause(watch_.outcome().pauses, watch_.clock().utc_now_ns(), phase);
      watch_.set_state(watch_.measurement().state(), phase);
    }
    watch_.follow(phase);
    try_generator();
    now = outlook();
  }
  go_on(began);
  if (now.kind == Kind::over) {
    return fail(now.reason);
  }
  return excitation_->begin();
}

// The analysis gives a step up when its sources have gone on for a while without it.
Expected<void> StepSequence::wait_for_broken_off(const std::stop_token& stop) {
  const std::uint32_t step = *std::exchange(broken_off_, std::nullopt);
  const Instant began = watch_.clock().now();
  excitation_->end();
  while (!stop.stop_requested() && !repeats_.is_evaluated(step, watch_.outcome().results) &&
         watch_.clock().now() - began < broken_off_limit && outlook().kind == Kind::well) {
    watch_.follow("waiting for the result of the step that was broken off");
  }
  return excitation_->begin();
}

// Connecting anew switches the output off; where a person does it, asks whether that is done.
void StepSequence::try_generator() {
  const Instant now = watch_.clock().now();
  if ((!by_generator_ && !excitation_->output_may_be_on()) ||
      now - generator_tried_ < generator_interval) {
    return;
  }
  const auto off = excitation_->switch_off();
  if (off.value_or(false)) {
    by_generator_.reset();
    watch_.confirm_off();
  } else if (!off && !excitation_->generator_is_away()) {
    by_generator_ = RunOutlook{Kind::over, off.error()};
  }
  generator_tried_ = watch_.clock().now();
}

void StepSequence::go_on(Instant since) {
  end_pause(watch_.outcome().pauses, watch_.clock().utc_now_ns());
  watch_.set_state(watch_.measurement().state());
  const std::chrono::duration<double> paused = watch_.clock().now() - since;
  watch_.notice(fmt::format("the run has paused for {:.0f} s", paused.count()));
}

Expected<bool> StepSequence::wait_until_evaluated(const std::stop_token& stop) {
  Instant changed = watch_.clock().now();
  std::size_t signs_before = watch_.signs_of_work();
  bool collected_again = false;
  while (!stop.stop_requested()) {
    watch_.follow("evaluating");
    for (const std::uint32_t step : watch_.commands().take_repeats()) {
      repeats_.ask_for(step);
    }
    if (watch_.analysis()->arm() == wire::ARM_FINISHED) {
      return false;
    }
    if (outlook().kind != Kind::well) {
      if (auto well = wait_until_well(stop); !well) {
        return watch_.analysis()->arm() == wire::ARM_FINISHED ? Expected<bool>(false)
                                                              : fail(well.error());
      }
      excitation_->end();
      changed = watch_.clock().now();
    }
    if (watch_.signs_of_work() != signs_before) {
      signs_before = watch_.signs_of_work();
      changed = watch_.clock().now();
    }
    const auto quiet = watch_.clock().now() - changed;
    if (quiet > last_result_quiet && repeats_.are_evaluated(watch_.outcome().results)) {
      return true;
    }
    if (quiet > missed_limit && !std::exchange(collected_again, true)) {
      watch_.collect_again();
    }
    if (quiet > results_limit) {
      return false;
    }
  }
  return false;
}

} // namespace dyncal::inline run
