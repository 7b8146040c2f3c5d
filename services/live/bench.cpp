#include "services/live/bench.hpp"

#include <tuple>

#include <fmt/core.h>

namespace dyncal::services::live {
namespace {

std::int64_t seconds_since(bus::Clock::Instant then, bus::Clock::Instant now) {
  return std::chrono::duration_cast<std::chrono::seconds>(now - then).count();
}

void worsen_by_run(const Run& run, bus::Clock::Instant now, Condition& condition) {
  if (run.is_left_alone(now)) {
    const std::string who = run.plan && !run.plan->conductor.empty()
                                ? "the conductor " + run.plan->conductor
                                : "the program that conducts the run";
    condition.worsen(Severity::stale, fmt::format("{} has not been heard for {} s", who,
                                                  seconds_since(*run.conductor_heard, now)));
  }
  if (run.state() == RunState::aborted) {
    const std::string& reason =
        run.message.empty() && run.analysis ? run.analysis->message : run.message;
    condition.worsen(Severity::error, "run aborted" + (reason.empty() ? "" : ": " + reason));
  }
  if (!run.is_over() && run.analysis && run.analysis->health == Health::failed) {
    condition.worsen(Severity::error, "the analysis has failed: " + run.analysis->message);
  }
  if (run.is_paused()) {
    const std::string& reason =
        run.message.empty() && run.analysis ? run.analysis->message : run.message;
    condition.worsen(Severity::warning, "paused: " + reason);
  }
  if (const std::size_t invalid = run.invalid_results(); invalid > 0) {
    condition.worsen(Severity::warning, fmt::format("{} results without a value", invalid));
  }
  if (const std::size_t flagged = run.flagged_results(); flagged > 0) {
    condition.worsen(Severity::note, fmt::format("{} results have flags", flagged));
  }
}

void worsen_by_recorder(const Service& recorder, bus::Clock::Instant now, Condition& condition) {
  if (now - recorder.heard > silence_limit) {
    return; // it ended with its run: whether it should have is not known here
  }
  if (!recorder.message.empty()) {
    condition.worsen(Severity::error, "recorder: " + recorder.message);
  }
  if (recorder.messages_not_stored > 0) {
    condition.worsen(Severity::warning, fmt::format("recorder: {} messages are not stored",
                                                    recorder.messages_not_stored));
  }
}

} // namespace

const char* to_string(BenchState state) {
  switch (state) {
  case BenchState::idle:
    break;
  case BenchState::arming:
    return "arming";
  case BenchState::running:
    return "running";
  case BenchState::paused:
    return "paused";
  case BenchState::done:
    return "done";
  case BenchState::aborted:
    return "aborted";
  case BenchState::silent:
    return "silent";
  case BenchState::gone:
    return "gone";
  }
  return "idle";
}

const Run* Bench::current_run() const {
  const Run* current = nullptr;
  const auto rank = [](const Run& run) {
    const bool is_conducted = !run.is_over() && run.conductor_heard.has_value();
    return std::make_tuple(is_conducted, run.time_utc_ns(), std::cref(run.name).get());
  };
  for (const auto& [name_of_run, run] : runs) {
    if (current == nullptr || rank(*current) < rank(run)) {
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
  const Run* run = service.is_recorder()  ? current_run()
                   : served == runs.end() ? nullptr
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
    condition.worsen(Severity::stale,
                     fmt::format("nothing heard for {} s", seconds_since(bench.heard, now)));
  }
  for (const auto& [name, source] : bench.sources) {
    Condition of_source = condition_of(source, now);
    condition.worsen(of_source.severity, std::move(of_source.what));
  }
  if (const Run* run = bench.current_run()) {
    worsen_by_run(*run, now, condition);
  }
  if (const Service* recorder = bench.recorder()) {
    worsen_by_recorder(*recorder, now, condition);
  }
  for (const auto& [name, service] : bench.services) {
    if (bench.is_silent(service, now)) {
      condition.worsen(Severity::stale, fmt::format("{} has not been heard for {} s", name,
                                                    seconds_since(service.heard, now)));
    }
  }
  return condition;
}

} // namespace dyncal::services::live
