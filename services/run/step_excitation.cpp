#include "services/run/step_excitation.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "analysis/base/frequency.hpp"
#include "services/run/level_meter.hpp"
#include "services/run/level_settling.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using drivers::generator::LevelControl;

constexpr auto shots_limit = 60s; // for the shots of one step, series time stamping
constexpr auto look_interval = 20ms;
constexpr double off_s = 0.3; // between two steps
constexpr double shot_slice_s = 0.25;
constexpr double max_listening_s = 10.0;  // beyond what it needs
constexpr double max_hum = 0.2;           // of a level: so far would the exciter be from it
constexpr double level_record_part = 0.5; // of the levels of a multi-sine's lines
constexpr double edge_frames = 4.0; // excitation_window.hpp: up to two frames are lost at each edge

// Time beyond settling and duration for which a step is excited, see
// analysis/step/excitation_window.hpp.
double margin_s(double frequency_hz) {
  return edge_frames * std::clamp(1.0 / frequency_hz, 0.1, 50.0 / frequency_hz);
}

analysis::Frequency frequency_of(const wire::PlannedStep& step) {
  return *analysis::Frequency::parse(step.frequency_text_hz()); // the bench file was checked
}

} // namespace

StepExcitation::StepExcitation(const RunEnvironment& environment, const BenchFile& bench,
                               std::string run, std::shared_ptr<bus::WakeUp> wake_up,
                               StepHooks hooks)
    : participant_(environment.participant), clock_(environment.clock), bench_(bench),
      run_(std::move(run)), wake_up_(std::move(wake_up)), hooks_(std::move(hooks)) {
  if (bench_.excitation.multisine) {
    multisine_.emplace(bench_);
  }
}

StepExcitation::~StepExcitation() = default;

Expected<std::unique_ptr<StepExcitation>> StepExcitation::open(const RunEnvironment& environment,
                                                               const BenchFile& bench,
                                                               const wire::Measurement& measurement,
                                                               std::shared_ptr<bus::WakeUp> wake_up,
                                                               StepHooks hooks) {
  std::unique_ptr<StepExcitation> excitation(new StepExcitation(
      environment, bench, measurement.run().to_string(), std::move(wake_up), std::move(hooks)));
  DYNCAL_TRY(excitation->check_levels(measurement));
  const auto listen = [self = excitation.get()](double now_s) { self->take_reference(now_s); };
  DYNCAL_TRY(excitation->generator_, DrivenGenerator::connect(environment, bench.generator,
                                                              excitation->hooks_.wait, listen));
  if (bench.method.kind == EvaluationMethod::series_timestamping) {
    DYNCAL_TRY(auto counter,
               ShotCounter::create(environment.participant, bench.bench, excitation->wake_up_));
    excitation->shots_.emplace(std::move(counter));
  }
  return excitation;
}

Expected<void> StepExcitation::check_levels(const wire::Measurement& measurement) const {
  if (multisine_) {
    return multisine_->check();
  }
  for (const wire::PlannedStep& step : measurement.steps()) {
    const auto voltage = drivers::generator::voltage_for_level(
        step.level_m_s2(), bench_.generator.level_per_volt, level_limits(bench_));
    if (!voltage) {
      return fail(of_step(step, ErrorCode::bad_argument, voltage.error().message));
    }
  }
  return {};
}

drivers::generator::LevelTarget StepExcitation::target_of(const wire::PlannedStep& step) const {
  const auto known = known_responses_.find(step.frequency_text_hz());
  const bool is_known = known != known_responses_.end();
  return {.level_m_s2 = step.level_m_s2(),
          .tolerance_rel = *bench_.generator.level_tolerance_rel,
          .level_per_volt = is_known ? known->second : bench_.generator.level_per_volt,
          .response_known = is_known,
          .corrections = level_corrections(static_cast<int>(step.repetition()))};
}

// Only while steps are excited: a reader that nobody empties would hold the source up.
Expected<void> StepExcitation::begin() {
  if (bench_.generator.level_tolerance_rel) {
    DYNCAL_TRY(auto meter,
               LevelMeter::create(participant_, bench_.bench, bench_.method.reference, wake_up_));
    meter_ = std::make_unique<LevelMeter>(std::move(meter));
  }
  return {};
}

void StepExcitation::end() {
  meter_.reset();
  quiet_levels_.reset(); // hum may have gone when steps are repeated
}

Expected<void> StepExcitation::excite(const wire::PlannedStep& step, std::uint32_t attempt,
                                      const std::stop_token& stop) {
  generator_->begin(step, stop);
  step_ = step;
  attempt_ = attempt;
  was_level_record_ = multisine_ && meter_ && !multisine_->has_levels();
  auto excited = was_level_record_ ? record_levels(step, stop) : hold_step(step, stop);
  if (const auto off = switch_off(); !off && excited && !stop.stop_requested()) {
    excited = fail(off.error());
  }
  if (excited && !stop.stop_requested()) {
    excited = generator_->wait_until_off();
  }
  if (!excited || stop.stop_requested() || was_level_record_) {
    announce(step, wire::EXCITATION_ABORTED);
    return excited;
  }
  announce(step, wire::EXCITATION_DONE);
  DYNCAL_TRY(const double now_s, generator_->now_s());
  const double pause_s = multisine_ ? std::max(off_s, multisine_->margin_s()) : off_s;
  return generator_->hold_until(now_s + pause_s).map([](bool) {});
}

void StepExcitation::take_reference(double now_s) {
  if (meter_) {
    meter_->take(now_s, multisine_ ? multisine_->period_s() + max_listening_s
                                   : LevelMeter::usually_kept_s);
  }
}

Expected<void> StepExcitation::hold_step(const wire::PlannedStep& step,
                                         const std::stop_token& stop) {
  const auto began = begin_step(step, stop);
  if (!began || stop.stop_requested()) {
    return began.map([](double) {});
  }
  const double steady_from_s = *began + step.settling_s();
  hooks_.show("settling");
  if (const auto settled = generator_->hold_until(steady_from_s); !settled || !*settled) {
    return settled.map([](bool) {});
  }
  if (shots_) {
    shots_->begin(run_, step.step(), attempt_);
  }
  announce(step, wire::EXCITATION_STEADY);
  hooks_.show("measuring");
  const double margin = multisine_ ? multisine_->margin_s() : margin_s(frequency_of(step).hz());
  const auto held = generator_->hold_until(steady_from_s + step.duration_s() + margin);
  if (!held || !*held || !shots_) {
    return held.map([](bool) {});
  }
  return hold_until_shots_are_taken(stop);
}

Expected<double> StepExcitation::begin_step(const wire::PlannedStep& step,
                                            const std::stop_token& stop) {
  if (multisine_) {
    return switch_on_multisine(step, 1.0);
  }
  return meter_ ? switch_on_to_level(step, stop)
                : switch_on(step, step.level_m_s2() / bench_.generator.level_per_volt);
}

Expected<double> StepExcitation::switch_on(const wire::PlannedStep& step, double voltage_v) {
  generator_->expect_output();
  auto set = generator_->instrument().set_frequency(step.frequency_text_hz()).and_then([&] {
    return generator_->instrument().set_amplitude_v(voltage_v);
  });
  return switch_on_as_set(step, std::move(set));
}

// The frequency is what the generator answers with, and what dyncal-guard knows the run by.
Expected<double> StepExcitation::switch_on_multisine(const wire::PlannedStep& step, double part) {
  hooks_.show("loading the waveform");
  auto set = generator_->instrument().set_frequency(step.frequency_text_hz()).and_then([&] {
    return generator_->instrument().set_waveform(multisine_->samples_v(part),
                                                 multisine_->rate_hz());
  });
  return switch_on_as_set(step, std::move(set));
}

// The bench time from which on the output is on.
Expected<double> StepExcitation::switch_on_as_set(const wire::PlannedStep& step,
                                                  drivers::Expected<void> set) {
  generator_->expect_output();
  if (set) {
    // Before the output is on: from then on dyncal-guard must know of it, whatever becomes of us.
    announce(step, wire::EXCITATION_SETTLING);
    set = generator_->instrument().set_output(true);
  }
  if (!set) {
    return fail(generator_->reported(set.error()));
  }
  DYNCAL_TRY(generator_->wait_for_effect());
  return generator_->now_s();
}

// The exciter settles, then a whole period is looked at.
Expected<void> StepExcitation::record_levels(const wire::PlannedStep& step,
                                             const std::stop_token& stop) {
  const auto began = switch_on_multisine(step, level_record_part);
  if (!began || stop.stop_requested()) {
    return began.map([](double) {});
  }
  hooks_.show("setting the levels of all lines");
  const double settled_s = *began + step.settling_s();
  const double period_s = multisine_->period_s();
  DYNCAL_TRY(generator_->hold_until(settled_s + period_s + level_transport_s));
  const double deadline_s = settled_s + period_s + level_transport_s + max_listening_s;
  while (!stop.stop_requested()) {
    DYNCAL_TRY(const double now_s, generator_->now_s());
    meter_->take(now_s, settled_s - *began + period_s + max_listening_s);
    DYNCAL_TRY(const auto levels,
               meter_->line_levels_after(settled_s, multisine_->frequencies_hz(), period_s));
    if (levels) {
      return multisine_->take_levels(*levels, level_record_part);
    }
    if (now_s > deadline_s) {
      return fail(generator_->fault_of_step(
          fmt::format("of {} no whole period of the waveform came; do its samples come?",
                      bench_.method.reference.text())));
    }
    clock_.wait(*wake_up_, clock_.now() + look_interval);
    DYNCAL_TRY(hooks_.wait.keep_alive());
  }
  return {};
}

// The same, and the level within its tolerance before the planned settling is over.
Expected<double> StepExcitation::switch_on_to_level(const wire::PlannedStep& step,
                                                    const std::stop_token& stop) {
  if (const auto quiet = refuse_hum(step, stop); !quiet || stop.stop_requested()) {
    return quiet.map([] { return 0.0; });
  }
  auto loop = LevelControl::start(target_of(step), level_limits(bench_));
  if (!loop) {
    return fail(of_step(step, ErrorCode::bad_argument, loop.error().message));
  }
  auto began = switch_on(step, loop->voltage_v());
  if (!began || stop.stop_requested()) {
    return began;
  }
  double changed_s = *began;
  for (;;) {
    const auto level = measure_level(changed_s, *began + step.settling_s(), stop);
    if (!level || !*level) {
      return level.map([&](std::optional<double>) { return *began; });
    }
    const auto reached = loop->take(**level);
    if (!reached) {
      known_responses_.erase(
          step.frequency_text_hz()); // nothing that another attempt may begin with
      const bool passes_limit = reached.error().code == drivers::ErrorCode::invalid_setting;
      return fail(passes_limit ? of_step(step, ErrorCode::device, reached.error().message)
                               : generator_->fault_of_step(reached.error().message));
    }
    known_responses_[step.frequency_text_hz()] = loop->level_per_volt();
    if (*reached) {
      return began;
    }
    if (const auto set = generator_->instrument().set_amplitude_v(loop->voltage_v()); !set) {
      return fail(generator_->reported(set.error()));
    }
    DYNCAL_TRY(changed_s, generator_->now_s());
  }
}

Expected<void> StepExcitation::refuse_hum(const wire::PlannedStep& step,
                                          const std::stop_token& stop) {
  if (!quiet_levels_) {
    auto listened = listen();
    if (!listened || stop.stop_requested()) {
      return listened;
    }
  }
  const double quiet_m_s2 = (*quiet_levels_)[step.frequency_text_hz()];
  return quiet_m_s2 <= max_hum * step.level_m_s2()
             ? Expected<void>{}
             : fail(generator_->fault_of_step(fmt::format(
                   "{} shows {:.3g} m/s^2 at this frequency while the output is off, and {:.3g} "
                   "are planned: it hums, and no level can be set by it",
                   bench_.method.reference.text(), quiet_m_s2, step.level_m_s2())));
}

// Samples may come late, as after the reader was made: what was not heard is not quiet.
Expected<void> StepExcitation::listen() {
  const auto& frequencies_hz = bench_.excitation.frequencies_hz;
  DYNCAL_TRY(const double began_s, generator_->now_s());
  hooks_.show("listening for hum");
  double until_s = began_s + listening_s(frequencies_hz);
  const double deadline_s = until_s + max_listening_s;
  while (until_s <= deadline_s) {
    const auto held = generator_->hold_until(until_s);
    if (!held || !*held) {
      return held.map([](bool) {});
    }
    if ((quiet_levels_ = meter_->quiet_levels_after(began_s, frequencies_hz))) {
      return {};
    }
    until_s += shot_slice_s;
  }
  return fail(generator_->fault_of_step(
      fmt::format("of {} no whole window of samples came while the output was off, so that nothing "
                  "tells whether it hums; do its samples come?",
                  bench_.method.reference.text())));
}

// Nothing if a stop was requested.
Expected<std::optional<double>> StepExcitation::measure_level(double changed_s, double deadline_s,
                                                              const std::stop_token& stop) {
  hooks_.show("setting the level");
  DYNCAL_TRY(generator_->hold_until(changed_s + bench_.excitation.settling_s));
  while (!stop.stop_requested()) {
    DYNCAL_TRY(const double now_s, generator_->now_s());
    meter_->take(now_s);
    const auto reading =
        meter_->level_after(changed_s + bench_.excitation.settling_s, frequency_of(step_),
                            0.5 * *bench_.generator.level_tolerance_rel);
    if (!reading) {
      known_responses_.erase(step_.frequency_text_hz());
      return fail(generator_->fault_of_step(reading.error().message));
    }
    if (reading->level_m_s2) {
      return reading->level_m_s2;
    }
    if (now_s > deadline_s) {
      known_responses_.erase(step_.frequency_text_hz());
      return fail(generator_->fault_of_step(
          fmt::format("{} shows no steady level {:.1f} s after it was set; {}",
                      bench_.method.reference.text(), now_s - changed_s, reading->lacking)));
    }
    clock_.wait(*wake_up_, clock_.now() + look_interval);
    DYNCAL_TRY(hooks_.wait.keep_alive());
  }
  return std::nullopt;
}

// A step without all of its shots is measured with those there are; the analysis reports how many.
Expected<void> StepExcitation::hold_until_shots_are_taken(const std::stop_token& stop) {
  const auto deadline = clock_.now() + shots_limit;
  while (shots_->shots() < bench_.method.shots && clock_.now() < deadline &&
         !stop.stop_requested()) {
    hooks_.show("shots");
    DYNCAL_TRY(const double now_s, generator_->now_s());
    DYNCAL_TRY(generator_->hold_until(now_s + shot_slice_s));
  }
  return {};
}

} // namespace dyncal::inline run
