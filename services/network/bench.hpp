// A bench as its messages show it: sources, services, runs, and what happened. Plain data and
// functions over it; what fills it is bus_state.hpp. One thread.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"
#include "services/network/condition.hpp"
#include "services/network/run.hpp"
#include "services/network/source.hpp"

namespace dyncal::network {

// A program that reports on the bench beside its sources: an analysis, a recorder, or the guard of
// the exciter.
struct Service {
  std::string name;
  std::string run; // of its newest report; of a recorder or guard empty
  Health health = Health::ok;
  std::string message;
  std::string software;
  std::string dds;
  std::string host;
  std::uint32_t process_id = 0;
  std::uint32_t contract_version = 0;
  std::string recording; // of a recorder, the file it writes
  std::uint64_t messages_stored = 0;
  std::uint64_t messages_not_stored = 0;
  std::string guarded_generator; // of a guard, its address
  bus::Clock::Instant heard{};
  std::int64_t heard_utc_ns = 0;

  // Its report, which has just come; when is for the caller to note.
  void take(const wire::ServiceStatus& report);
  [[nodiscard]] bool is_recorder() const { return !recording.empty(); }
  [[nodiscard]] bool is_guard() const { return !guarded_generator.empty(); }
  // The run that a guard names is one that it does not hear.
  [[nodiscard]] bool is_analysis() const { return !run.empty() && !is_guard(); }
};

enum class BenchState { idle, arming, running, paused, done, aborted, silent, gone };
// "running"
[[nodiscard]] const char* to_string(BenchState state);

struct Bench {
  using Instant = bus::Clock::Instant;

  std::string name;
  std::map<std::string, Source> sources;
  std::map<std::string, Service> services;
  std::map<std::string, Run> runs;
  std::deque<Event> events; // the newest last
  Instant heard{};          // of anything
  std::int64_t heard_utc_ns = 0;
  std::uint64_t number = 0; // of the laboratory's state when it changed last
  BenchState state = BenchState::idle;

  // The one that is conducted, else the one that was first heard of last; null: none was heard of.
  [[nodiscard]] const Run* current_run() const;
  [[nodiscard]] const Service* recorder() const;
  // It should be heard, as the run that it serves is being conducted, and is not.
  [[nodiscard]] bool is_silent(const Service& service, Instant now) const;
  [[nodiscard]] std::uint64_t lost() const;
};

[[nodiscard]] BenchState state_of(const Bench& bench, bus::Clock::Instant now);
// The worst of the bench, its sources, services and its current run.
[[nodiscard]] Condition condition_of(const Bench& bench, bus::Clock::Instant now);

} // namespace dyncal::network
