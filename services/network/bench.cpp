#include "services/network/bench.hpp"

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/printable_text.hpp"

namespace dyncal::network {
namespace {

std::int64_t seconds_since(bus::Clock::Instant then, bus::Clock::Instant now) {
  return std::chrono::duration_cast<std::chrono::seconds>(now - then).count();
}

// One run of a bench before another: what is conducted, then what is newer. Not by when the runs
// were planned: that is by the clocks of their conductors, which may be two hosts. Of runs that
// were over before anybody listened messages come in no order; there the clock of the analysis
// tells, if it is one that reports on both.
bool leads(const Run& run, const Run& other) {
  const auto is_conducted = [](const Run& one) {
    return !one.is_over() && one.conductor_heard.has_value();
  };
  if (is_conducted(run) != is_conducted(other)) {
    return is_conducted(run);
  }
  const bool by_one_analysis = !run.conductor_heard && !other.conductor_heard && run.analysis &&
                               other.analysis && run.analysis->service == other.analysis->service;
  if (by_one_analysis && run.analysis->published_utc_ns != other.analysis->published_utc_ns) {
    return run.analysis->published_utc_ns > other.analysis->published_utc_ns;
  }
  return run.place > other.place;
}

void raise_severity_by_run(const Run& run, bus::Clock::Instant now, Condition& condition) {
  if (run.is_left_alone(now)) {
    const std::string who = run.plan && !run.plan->conductor.empty()
                                ? "the conductor " + run.plan->conductor
                                : "the program that conducts the run";
    condition.raise_severity(Severity::stale,
                             fmt::format("{} has not been heard for {} s", who,
                                         seconds_since(*run.conductor_heard, now)));
  }
  if (run.state() == RunState::aborted) {
    const std::string& reason =
        run.message.empty() && run.analysis ? run.analysis->message : run.message;
    condition.raise_severity(Severity::error,
                             "run aborted" + (reason.empty() ? "" : ": " + reason));
  }
  if (!run.is_over() && run.analysis && run.analysis->health == Health::failed) {
    condition.raise_severity(Severity::error, "the analysis has failed: " + run.analysis->message);
  }
  // That two programs send as one source, among others.
  if (!run.is_over() && run.analysis && !run.analysis->message.empty()) {
    condition.raise_severity(Severity::note, run.analysis->message);
  }
  if (run.is_paused()) {
    const std::string& reason =
        run.message.empty() && run.analysis ? run.analysis->message : run.message;
    condition.raise_severity(Severity::warning, "paused: " + reason);
  }
  if (const std::size_t invalid = run.invalid_results(); invalid > 0) {
    condition.raise_severity(Severity::warning, fmt::format("{} results without a value", invalid));
  }
  if (const std::size_t flagged = run.flagged_results(); flagged > 0) {
    condition.raise_severity(Severity::note, fmt::format("{} results have flags", flagged));
  }
}

void raise_severity_by_recorder(const Service& recorder, bus::Clock::Instant now,
                                Condition& condition) {
  if (now - recorder.heard > silence_limit) {
    return; // it ended with its run: whether it should have is not known here
  }
  if (!recorder.message.empty()) {
    condition.raise_severity(Severity::error, "recorder: " + recorder.message);
  }
  if (recorder.messages_not_stored > 0) {
    condition.raise_severity(Severity::warning, fmt::format("recorder: {} messages are not stored",
                                                            recorder.messages_not_stored));
  }
}

void raise_severity_by_guard(const Service& guard, bus::Clock::Instant now, Condition& condition) {
  if (guard.health == Health::failed && now - guard.heard <= silence_limit) {
    condition.raise_severity(Severity::error, "guard: " + guard.message);
  }
}

} // namespace

void Service::take(const wire::ServiceStatus& report) {
  name = report.service().to_string();
  run = report.run().to_string();
  health = report.health() == wire::HEALTH_OK       ? Health::ok
           : report.health() == wire::HEALTH_FAILED ? Health::failed
                                                    : Health::waiting;
  message = one_line(report.message());
  software = one_line(report.software());
  dds = one_line(report.dds());
  host = one_line(report.host());
  process_id = report.process_id();
  contract_version = report.contract_version();
  recording = one_line(report.recording());
  messages_stored = report.messages_stored();
  messages_not_stored = report.messages_not_stored();
  guarded_generator = one_line(report.guarded_generator());
}

const char* to_string(BenchState state) {
  return per_enumerator(
      state, {"idle", "arming", "running", "paused", "done", "aborted", "silent", "gone"});
}

const Run* Bench::current_run() const {
  const Run* current = nullptr;
  for (const auto& [name_of_run, run] : runs) {
    if (current == nullptr || leads(run, *current)) {
      current = &run;
    }
  }
  return current;
}

const Service* Bench::recorder() const {
  const Service* newest = nullptr;
  for (const auto& [name_of_service, service] : services) {
    if (service.is_recorder() && (newest == nullptr || newest->heard < service.heard)) {
      newest = &service;
    }
  }
  return newest;
}

bool Bench::is_silent(const Service& service, Instant now) const {
  const auto served = runs.find(service.run);
  const Run* run = service.is_recorder() || service.is_guard() ? current_run()
                   : served == runs.end()                      ? nullptr
                                                               : &served->second;
  const bool is_conducted =
      run != nullptr && run->conductor_heard && !run->is_over() && !run->is_left_alone(now);
  return is_conducted && now - service.heard > silence_limit;
}

std::uint64_t Bench::lost() const {
  std::uint64_t sum = 0;
  for (const auto& [name_of_source, source] : sources) {
    sum += source.lost();
  }
  return sum;
}

BenchState state_of(const Bench& bench, bus::Clock::Instant now) {
  if (now - bench.heard > gone_limit) {
    return BenchState::gone;
  }
  if (now - bench.heard > silence_limit) {
    return BenchState::silent;
  }
  const Run* run = bench.current_run();
  if (run == nullptr) {
    return BenchState::idle;
  }
  if (run->is_left_alone(now)) {
    return BenchState::silent;
  }
  switch (run->state()) {
  case RunState::unknown:
    return BenchState::idle;
  case RunState::planned:
    return BenchState::arming;
  case RunState::running:
    return run->is_paused() ? BenchState::paused : BenchState::running;
  case RunState::done:
    return BenchState::done;
  case RunState::aborted:
    return BenchState::aborted;
  }
  return BenchState::idle;
}

Condition condition_of(const Bench& bench, bus::Clock::Instant now) {
  Condition condition;
  if (now - bench.heard > silence_limit) {
    condition.raise_severity(
        Severity::stale, fmt::format("nothing heard for {} s", seconds_since(bench.heard, now)));
  }
  for (const auto& [name, source] : bench.sources) {
    Condition of_source = condition_of(source, now);
    condition.raise_severity(of_source.severity, std::move(of_source.what));
  }
  if (const Run* run = bench.current_run()) {
    raise_severity_by_run(*run, now, condition);
  }
  if (const Service* recorder = bench.recorder()) {
    raise_severity_by_recorder(*recorder, now, condition);
  }
  for (const auto& [name, service] : bench.services) {
    if (service.is_guard()) {
      raise_severity_by_guard(service, now, condition);
    }
    if (bench.is_silent(service, now)) {
      condition.raise_severity(Severity::stale, fmt::format("{} has not been heard for {} s", name,
                                                            seconds_since(service.heard, now)));
    }
  }
  return condition;
}

} // namespace dyncal::network
