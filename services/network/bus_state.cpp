#include "services/network/bus_state.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/bus/names.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/network/bounded_results.hpp"
#include "services/network/changes.hpp"

namespace dyncal::network {
namespace {

// What was heard of longest ago makes way, if it is gone.
template <class Held>
bool drop_gone(std::map<std::string, Held>& held, bus::Clock::Instant now) {
  const auto oldest = std::ranges::min_element(
      held, [](const auto& a, const auto& b) { return a.second.heard < b.second.heard; });
  if (oldest == held.end() || now - oldest->second.heard <= gone_limit) {
    return false;
  }
  held.erase(oldest);
  return true;
}

} // namespace

const Bench* BusState::bench(const std::string& name) const {
  const auto found = benches_.find(name);
  return found == benches_.end() ? nullptr : &found->second;
}

// Of a message that has just come; null if there is no room.
Bench* BusState::bench_of(const std::string& name) {
  auto found = benches_.find(name);
  if (found == benches_.end()) {
    if (!bus::check_bench_name(name) ||
        (benches_.size() >= limits_.benches && !make_room_for_bench())) {
      ++left_out_.benches;
      return nullptr;
    }
    found = benches_.try_emplace(name).first;
    found->second.name = name;
  }
  Bench& bench = found->second;
  bench.heard = clock_.now();
  bench.heard_utc_ns = clock_.utc_now_ns();
  changed(bench);
  return &bench;
}

bool BusState::make_room_for_bench() {
  const bool made = drop_gone(benches_, clock_.now());
  number_ += made ? 1 : 0;
  return made;
}

Source* BusState::source_of(Bench& bench, const std::string& name) {
  if (!bench.sources.contains(name) && bench.sources.size() >= limits_.sources) {
    ++left_out_.sources; // this one, or the one that makes way
    if (!drop_gone(bench.sources, clock_.now())) {
      return nullptr;
    }
  }
  Source& source = bench.sources[name];
  source.name = name;
  source.heard = clock_.now();
  source.heard_utc_ns = clock_.utc_now_ns();
  source.is_silent = false;
  return &source;
}

Run* BusState::run_of(Bench& bench, const std::string& name) {
  auto found = bench.runs.find(name);
  if (found == bench.runs.end()) {
    if (name.empty() || (bench.runs.size() >= limits_.runs && !make_room_for_run(bench))) {
      ++left_out_.runs;
      return nullptr;
    }
    found = bench.runs.try_emplace(name).first;
    found->second.name = name;
    found->second.place = ++runs_heard_;
    results_changed(found->second);
  }
  found->second.heard = clock_.now();
  return &found->second;
}

// The run that nobody conducts and that was heard of longest ago makes way.
bool BusState::make_room_for_run(Bench& bench) {
  const bus::Clock::Instant now = clock_.now();
  const auto is_in_use = [&](const Run& run) {
    return !run.is_over() && !run.is_left_alone(now) && run.conductor_heard.has_value();
  };
  auto oldest = bench.runs.end();
  for (auto run = bench.runs.begin(); run != bench.runs.end(); ++run) {
    const bool is_older = oldest == bench.runs.end() || run->second.heard < oldest->second.heard;
    if (!is_in_use(run->second) && is_older) {
      oldest = run;
    }
  }
  if (oldest == bench.runs.end()) {
    return false;
  }
  bench.runs.erase(oldest);
  ++left_out_.runs;
  return true;
}

std::size_t BusState::results() const {
  std::size_t sum = 0;
  for (const auto& [name, bench] : benches_) {
    for (const auto& [run_name, run] : bench.runs) {
      sum += run.results.size();
    }
  }
  return sum;
}

bool BusState::make_room_for_result(const Run& run) {
  return run.results.size() < limits_.results_of_run &&
         (results() < limits_.results || drop_results_of_oldest(run));
}

// Of all runs but this one.
bool BusState::drop_results_of_oldest(const Run& run) {
  Run* oldest = nullptr;
  for (auto& [name, bench] : benches_) {
    for (auto& [run_name, other] : bench.runs) {
      const bool is_older = oldest == nullptr || other.heard < oldest->heard;
      if (&other != &run && !other.results.empty() && is_older) {
        oldest = &other;
      }
    }
  }
  if (oldest == nullptr) {
    return false;
  }
  left_out_.results += oldest->results.size();
  oldest->results.clear();
  oldest->newest_result.reset();
  results_changed(*oldest);
  return true;
}

void BusState::take(const wire::SourceDescription& message) {
  Bench* bench = bench_of(message.bench().to_string());
  Source* source = bench == nullptr ? nullptr : source_of(*bench, message.source().to_string());
  if (source != nullptr) {
    source->take(message, limits_);
  }
}

void BusState::take(const wire::SourceStatus& message) {
  Bench* bench = bench_of(message.bench().to_string());
  if (bench == nullptr) {
    return;
  }
  const auto known = bench->sources.find(message.source().to_string());
  const Source before = known == bench->sources.end() ? Source{} : known->second;
  if (Source* source = source_of(*bench, message.source().to_string())) {
    source->take(message, limits_, clock_.now());
    note(*bench, changes_of(before, *source));
  }
}

void BusState::take(const wire::Measurement& message) {
  Bench* bench = bench_of(message.bench().to_string());
  Run* run = bench == nullptr ? nullptr : run_of(*bench, message.run().to_string());
  if (run == nullptr) {
    return;
  }
  const RunBefore before = state_before(*run);
  run->take(message, limits_, clock_.now());
  note(*bench, changes_of(before, *run));
}

void BusState::take(const wire::Excitation& message) {
  Bench* bench = bench_of(message.bench().to_string());
  Run* run = bench == nullptr ? nullptr : run_of(*bench, message.run().to_string());
  if (run == nullptr) {
    return;
  }
  const bool was_aborted = run->now && run->now->step.state == StepState::aborted;
  run->take(message, clock_.now());
  if (run->now->step.state == StepState::aborted && !was_aborted) {
    note(*bench, Severity::warning,
         fmt::format("{}: the excitation of step {} was broken off", run->name,
                     run->now->step.step));
  }
}

void BusState::take(const wire::CalibrationResult& message) {
  Bench* bench = bench_of(message.bench().to_string());
  Run* run = bench == nullptr ? nullptr : run_of(*bench, message.run().to_string());
  if (run == nullptr) {
    return;
  }
  StepResult result = from_message(message);
  bound(result, limits_);
  Run::ResultKey key{result.step, result.repetition, result.channel};
  const auto known = run->results.find(key);
  if (known == run->results.end() && !make_room_for_result(*run)) {
    ++left_out_.results;
    return;
  }
  if (known != run->results.end() && result.attempt < known->second.attempt) {
    return;
  }
  const bool is_new = known == run->results.end() || known->second.valid;
  if (!result.valid && is_new) {
    note(*bench, Severity::warning,
         fmt::format("{}: no result of {} in step {}: {}", run->name, result.channel, result.step,
                     result.problem));
  }
  run->results.insert_or_assign(key, std::move(result));
  run->newest_result = std::move(key);
  results_changed(*run);
}

void BusState::take(const wire::TransferFunction& message) {
  Bench* bench = bench_of(message.bench().to_string());
  Run* run = bench == nullptr ? nullptr : run_of(*bench, message.run().to_string());
  if (run == nullptr) {
    return;
  }
  TransferFunction function = from_message(message);
  const bool is_known = run->transfer_functions.contains(function.channel);
  if (!is_known && run->transfer_functions.size() >= limits_.channels) {
    ++left_out_.results;
    return;
  }
  bound(function, limits_);
  run->transfer_functions.insert_or_assign(function.channel, std::move(function));
  results_changed(*run);
}

void BusState::take(const wire::SampleClockReport& message) {
  Bench* bench = bench_of(message.bench().to_string());
  Run* run = bench == nullptr ? nullptr : run_of(*bench, message.run().to_string());
  if (run == nullptr) {
    return;
  }
  ClockReport report = from_message(message);
  const bool is_known = run->clock_reports.contains(report.source);
  if (!is_known && run->clock_reports.size() >= limits_.sources) {
    ++left_out_.results;
    return;
  }
  bound(report, limits_);
  run->clock_reports.insert_or_assign(report.source, std::move(report));
  results_changed(*run);
}

void BusState::take(const wire::ServiceStatus& message) {
  Bench* bench = bench_of(message.bench().to_string());
  if (bench == nullptr) {
    return;
  }
  take_service(*bench, message);
  // Of a recorder or guard; the run that a guard names is one that it does not hear.
  if (message.run().to_string().empty() || !message.guarded_generator().empty()) {
    return;
  }
  Run* run = run_of(*bench, message.run().to_string());
  if (run == nullptr) {
    return;
  }
  const RunBefore before = state_before(*run);
  run->take(message, clock_.now());
  note(*bench, changes_of(before, *run));
}

void BusState::take_of_recorder(wire::ServiceStatus message) {
  if (message.recording().empty() || !message.service().to_string().starts_with("recorder@")) {
    return;
  }
  message.run("");
  message.guarded_generator("");
  take(message);
}

void BusState::take_service(Bench& bench, const wire::ServiceStatus& message) {
  const std::string name = message.service().to_string();
  if (!bench.services.contains(name) && bench.services.size() >= limits_.services) {
    ++left_out_.services; // this one, or the one that makes way
    if (!drop_gone(bench.services, clock_.now())) {
      return;
    }
  }
  Service& service = bench.services[name];
  const std::string message_before = service.message;
  service.take(message);
  service.heard = clock_.now();
  service.heard_utc_ns = clock_.utc_now_ns();
  if (service.is_recorder() && !service.message.empty() && service.message != message_before) {
    note(bench, Severity::error, "recorder: " + service.message);
  }
  if (service.is_guard() && !service.message.empty() && service.message != message_before) {
    note(bench, service.health == Health::failed ? Severity::error : Severity::warning,
         "guard: " + service.message);
  }
}

void BusState::set_programs(std::vector<DiscoveredProgram> programs,
                            std::vector<HostClock> clocks) {
  if (programs.size() != programs_.size() || clocks.size() != clocks_.size()) {
    ++number_;
  }
  programs_ = std::move(programs);
  clocks_ = std::move(clocks);
}

void BusState::work() {
  const bus::Clock::Instant now = clock_.now();
  for (auto& [name, bench] : benches_) {
    for (auto& [source_name, source] : bench.sources) {
      if (!source.is_silent && now - source.heard > silence_limit) {
        source.is_silent = true;
        changed(bench);
        if (source.state != SourceState::ended) {
          note(bench, Severity::stale, fmt::format("{} has gone silent", source_name));
        }
      }
    }
    const BenchState state = state_of(bench, now);
    if (state != bench.state) {
      if (state == BenchState::silent) {
        note(bench, Severity::stale, condition_of(bench, now).what);
      }
      bench.state = state;
      changed(bench);
    }
  }
}

void BusState::note(Bench& bench, Severity severity, const std::string& text) {
  bench.events.push_back({clock_.utc_now_ns(), bench.name, severity, one_line(text)});
  if (bench.events.size() > limits_.events) {
    bench.events.pop_front();
  }
  changed(bench);
}

void BusState::note(Bench& bench, const std::vector<Condition>& changes) {
  for (const Condition& change : changes) {
    note(bench, change.severity, change.what);
  }
}

std::optional<ClockOffset> BusState::clock_of(const std::string& host) const {
  const auto found = std::ranges::find(clocks_, host, &HostClock::host);
  return found == clocks_.end() ? std::nullopt : std::optional(found->clock);
}

std::optional<ClockOffset> BusState::worst_clock(const Bench& bench) const {
  std::optional<ClockOffset> worst;
  const auto look_at = [&](const std::string& host) {
    const auto clock = clock_of(host);
    if (clock && (!worst || std::abs(clock->offset_s) > std::abs(worst->offset_s))) {
      worst = clock;
    }
  };
  for (const auto& [name, source] : bench.sources) {
    look_at(source.host);
  }
  for (const auto& [name, service] : bench.services) {
    look_at(service.host);
  }
  return worst;
}

std::vector<Event> BusState::events() const {
  std::vector<Event> all;
  for (const auto& [name, bench] : benches_) {
    all.insert(all.end(), bench.events.begin(), bench.events.end());
  }
  std::ranges::stable_sort(all, [](const Event& a, const Event& b) { return a.utc_ns < b.utc_ns; });
  if (all.size() > limits_.events) {
    all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(limits_.events));
  }
  return all;
}

} // namespace dyncal::network
