#include "services/programs/guard/exciter_guard.hpp"

#include <charconv>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "services/bus/names.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline programs {
namespace {

using State = ExciterWatch::State;

constexpr std::chrono::milliseconds look_interval{100};
constexpr std::chrono::milliseconds status_write_limit{50}; // it is repeated
constexpr std::chrono::seconds longest_between_steps{2};    // of a run that does not pause

wire::ServiceStatus status_of(const ProgramIdentity& own, const GuardedExciter& exciter) {
  wire::ServiceStatus status;
  status.bench(exciter.bench);
  status.service(fmt::format("guard@{}:{}", own.host, own.process_id).substr(0, bus::max_name));
  status.arm(wire::ARM_WAITING);
  status.health(wire::HEALTH_OK);
  status.software(own.software);
  status.dds(own.dds);
  status.host(own.host);
  status.process_id(own.process_id);
  status.contract_version(wire::CONTRACT_VERSION);
  status.guarded_generator(exciter.generator);
  return status;
}

bool is_driven(const wire::Excitation& excitation) {
  return excitation.window_end_utc_ns() == 0;
}

RunPhase phase_of(wire::MeasurementState state) {
  if (state == wire::MEASUREMENT_PLANNED) {
    return RunPhase::planned;
  }
  return state == wire::MEASUREMENT_RUNNING ? RunPhase::running : RunPhase::over;
}

std::string text_of(const OutputSettings& settings) {
  return fmt::format(
      "{:.6g} Hz{}", settings.frequency_hz,
      settings.voltage_vpp ? fmt::format(", {:.4g} V peak to peak", *settings.voltage_vpp) : "");
}

} // namespace

Expected<std::unique_ptr<ExciterGuard>>
ExciterGuard::create(bus::Participant& participant, const ProgramIdentity& own,
                     const GuardedExciter& exciter, std::unique_ptr<GuardedOutput> output,
                     DrivenRecord record, bus::Clock& clock) {
  auto wake_up = std::make_shared<bus::WakeUp>();
  DYNCAL_TRY(auto excitation, participant.reader(bus::topics::excitation, exciter.bench, wake_up));
  DYNCAL_TRY(auto measurement,
             participant.reader(bus::topics::measurement, exciter.bench, wake_up));
  DYNCAL_TRY(auto status, participant.writer(bus::topics::service_status, exciter.bench));
  ExciterWatch watch(exciter.planned, record.read(), clock.now());
  if (!watch.run().run.empty()) {
    spdlog::info("bench {}: run {} drove the generator when this guard was last there",
                 exciter.bench, watch.run().run);
  }
  std::optional<ReferenceWatch> reference;
  if (exciter.reference) {
    std::vector<double> planned_hz;
    for (const OutputSettings& settings : exciter.planned) {
      planned_hz.push_back(settings.frequency_hz);
    }
    // Its blocks do not wake the guard up: it looks often enough.
    reference.emplace(participant, exciter.bench, *exciter.reference, planned_hz,
                      std::make_shared<bus::WakeUp>());
  }
  return std::unique_ptr<ExciterGuard>(new ExciterGuard(
      status_of(own, exciter), exciter, std::move(watch), std::move(reference), std::move(output),
      std::move(record), clock,
      {std::move(excitation), std::move(measurement), std::move(status), std::move(wake_up)}));
}

void ExciterGuard::serve(const std::stop_token& stop, const std::function<void()>& turned) {
  while (!stop.stop_requested()) {
    if (turned) {
      turned();
    }
    clock_.wait(*endpoints_.wake_up, clock_.now() + look_interval);
    work();
  }
}

void ExciterGuard::work() {
  take_messages();
  act();
  look_at_reference();
  keep_record();
  report();
  if (clock_.now() >= next_status_) {
    publish();
  }
}

GuardFigures ExciterGuard::figures() const {
  return {.bench = exciter_.bench, .switched_off = times_switched_off_, .may_be_on = may_be_on()};
}

void ExciterGuard::publish() {
  status_.published_utc_ns(clock_.utc_now_ns());
  endpoints_.status.write(status_, status_write_limit);
  next_status_ = clock_.now() + status_interval;
}

OutputSettings ExciterGuard::settings_of(const wire::Excitation& excitation) const {
  OutputSettings settings;
  const std::string& text = excitation.frequency_text_hz();
  std::from_chars(text.data(), text.data() + text.size(), settings.frequency_hz);
  if (!exciter_.has_closed_loop) {
    settings.voltage_vpp = 2.0 * excitation.level_m_s2() / exciter_.level_per_volt;
  }
  return settings;
}

void ExciterGuard::take_messages() {
  endpoints_.measurement.take_with_writer(
      [&](const wire::Measurement& measurement, const bus::WriterId& writer) {
        if (measurement.bench().to_string() == exciter_.bench) {
          take(measurement, writer);
        }
      });
  take_passed_over();
  endpoints_.excitation.take_with_writer(
      [&](const wire::Excitation& excitation, const bus::WriterId& writer) {
        if (excitation.bench().to_string() == exciter_.bench) {
          take(excitation, writer);
        }
      });
  if (conductor_.passed_over() > passed_over_said_ && clock_.now() >= next_passed_over_) {
    next_passed_over_ = clock_.now() + report_interval;
    spdlog::warn("bench {}: messages about its runs come from other programs than the conductor of "
                 "run {}, or are repeated; so far {} were passed over",
                 exciter_.bench, conductor_.conductor().run, conductor_.passed_over());
    passed_over_said_ = conductor_.passed_over();
  }
}

bool ExciterGuard::may_conductor_change() const {
  const bool is_alive =
      watch_.run().is_conducted && clock_.now() - conductor_.heard_at() <= ExciterWatch::word_limit;
  return conductor_.conductor().run.empty() || (watch_.is_known_off() && !is_alive);
}

void ExciterGuard::take(const wire::Measurement& measurement, const bus::WriterId& writer) {
  const std::string run = measurement.run().to_string();
  const RunPhase phase = phase_of(measurement.state());
  if (conductor_.believes(measurement, writer, phase != RunPhase::over && may_conductor_change(),
                          clock_.now())) {
    watch_.heard_run(run, phase, clock_.now());
  } else if (phase == RunPhase::running && run != conductor_.conductor().run) {
    other_run_ = {run, clock_.now()};
  }
}

void ExciterGuard::take(const wire::Excitation& excitation, const bus::WriterId& writer) {
  if (conductor_.believes(excitation, writer, may_conductor_change(), clock_.now())) {
    heard(excitation);
    return;
  }
  const std::string run = excitation.run().to_string();
  if (is_driven(excitation) && run != conductor_.conductor().run) {
    other_run_ = {run, clock_.now()};
  } else if (!is_driven(excitation) && writer.participant() != conductor_.conductor().participant) {
    passed_over_ = {excitation, writer, clock_.now()};
  }
}

void ExciterGuard::take_passed_over() {
  if (!passed_over_) {
    return;
  }
  const bool is_of_conductor =
      passed_over_->writer.participant() == conductor_.conductor().participant;
  if (is_of_conductor &&
      conductor_.believes(passed_over_->excitation, passed_over_->writer, false, clock_.now())) {
    heard(passed_over_->excitation);
    passed_over_.reset();
  } else if (is_of_conductor || clock_.now() - passed_over_->at > passed_over_for) {
    passed_over_.reset();
  }
}

void ExciterGuard::heard(const wire::Excitation& excitation) {
  const std::string name = excitation.run().to_string();
  if (is_driven(excitation) && name != watched_run_) {
    watched_run_ = name;
    spdlog::info("bench {}: watching over run {}", exciter_.bench, name);
  }
  const bool is_broken_off = excitation.state() == wire::EXCITATION_ABORTED;
  watch_.heard({.run = name,
                .is_driven = is_driven(excitation),
                .settings = settings_of(excitation),
                .is_in_hand = !is_driven(excitation) || !is_broken_off},
               clock_.now());
}

std::string ExciterGuard::unheard_run() const {
  if (watch_.state() == State::silent) {
    return watch_.run().run;
  }
  const bool is_there = clock_.now() - other_run_.heard <= ExciterWatch::word_limit;
  return is_there && other_run_.run != conductor_.conductor().run ? other_run_.run : "";
}

void ExciterGuard::act() {
  if (const auto answer = output_->answer()) {
    watch_.answered(*answer, clock_.now());
  }
  switch (watch_.due(clock_.now())) {
  case ExciterWatch::Action::none:
    break;
  case ExciterWatch::Action::ask:
    output_->ask();
    break;
  case ExciterWatch::Action::switch_off: {
    const auto unheard = clock_.now() - watch_.heard_at();
    const auto off = output_->switch_off();
    watch_.switched_off(off, clock_.now());
    if (off) {
      ++times_switched_off_;
      spdlog::warn("bench {}: nothing was heard of run {} for {:.1f} s while its exciter was "
                   "driven; the output of the generator was switched off",
                   exciter_.bench, watch_.run().run,
                   std::chrono::duration<double>(unheard).count());
    }
    break;
  }
  }
}

void ExciterGuard::look_at_reference() {
  if (!reference_) {
    return;
  }
  using Phase = ReferenceWatch::Phase;
  const auto& settings = watch_.run().settings;
  Phase phase = Phase::off;
  switch (watch_.state()) {
  case State::idle: // what goes on is said until it does not
    phase = reference_->still_driven().empty() ? Phase::unwatched : Phase::off;
    break;
  case State::begins:
    phase = Phase::quiet;
    break;
  case State::driven:
    phase = Phase::driven;
    break;
  case State::silent:
    phase = watch_.has_switched_off() ? Phase::off : Phase::driven;
    break;
  case State::ended:
    break;
  }
  reference_->look(phase, settings.empty() ? 0.0 : settings.back().frequency_hz, watch_.heard_at(),
                   clock_.now());
}

// A guard that starts with what was driven switches off the same as one that starts with a step
// that has just ended, and the next step would be written anyway.
bool ExciterGuard::is_between_steps() const {
  DrivenRun driven = watch_.run();
  driven.has_ended = false;
  return watch_.run().is_conducted && driven == recorded_ &&
         clock_.now() - watch_.heard_at() < longest_between_steps;
}

void ExciterGuard::keep_record() {
  if (watch_.run() == recorded_ || is_between_steps()) {
    return;
  }
  recorded_ = watch_.run();
  const auto written = record_.write(recorded_, conductor_.conductor());
  if (!written && !std::exchange(record_failed_, true)) {
    spdlog::error("bench {}: after a restart this guard will not know what was driven: {}",
                  exciter_.bench, written.error().message);
  }
  record_failed_ = !written;
}

bool ExciterGuard::may_be_on() const {
  const bool is_persons = watch_.left_on().has_value();
  return !watch_.may_be_on().empty() ||
         (reference_ && !is_persons && !reference_->still_driven().empty());
}

std::string ExciterGuard::message() const {
  if (!watch_.may_be_on().empty()) {
    return fmt::format("nothing is heard of run {}, and THE OUTPUT OF THE GENERATOR MAY BE ON: "
                       "switch it off by hand if you can; trying again until it is off ({})",
                       watch_.run().run, watch_.may_be_on());
  }
  if (may_be_on()) { // the same words until that ends: a run passes each on
    return fmt::format("the generator answers that its output is off, but {}: THE OUTPUT OF THE "
                       "GENERATOR MAY BE ON, or something else drives the exciter; switch it off "
                       "by hand",
                       reference_->still_driven());
  }
  if (watch_.left_on()) {
    return fmt::format("the output of the generator is on ({}), which is not what run {} drove: it "
                       "is left on",
                       text_of(*watch_.left_on()), watch_.run().run);
  }
  if (watch_.has_switched_off()) {
    return fmt::format("nothing was heard of run {} while its exciter was driven; the output of "
                       "the generator was switched off",
                       watch_.run().run);
  }
  return "";
}

// As soon as it has changed.
void ExciterGuard::report() {
  const bool has_failed = may_be_on();
  if (has_failed && clock_.now() >= next_report_) {
    next_report_ = clock_.now() + report_interval;
    spdlog::error("bench {}: {}", exciter_.bench, message());
  } else if (!has_failed) {
    next_report_ = {};
  }
  const std::string unheard = unheard_run();
  const auto health = has_failed ? wire::HEALTH_FAILED : wire::HEALTH_OK;
  const std::string now = message();
  if (status_.health() == health && status_.message() == now &&
      status_.run().to_string() == unheard) {
    return;
  }
  if (watch_.left_on() && status_.message() != now) {
    spdlog::warn("bench {}: {}", exciter_.bench, now);
  }
  status_.health(health);
  status_.message(now);
  status_.run(unheard);
  publish();
}

} // namespace dyncal::inline programs
