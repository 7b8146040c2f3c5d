// All benches of a laboratory as the bus shows them now, from the messages it is fed with.
//
// Anyone who has the messages calls take(), and work() at least twice a second: it notices what has
// gone silent. Time is that of `clock`; nothing is read or waited for here. number() grows with
// every change, so that anyone who shows it knows that there is something new; Bench::number is
// that of the bench's last change. A late listener gets what the topics keep for him: descriptions,
// states and results; of a run whose conductor has ended, no plan.
//
// Bounded by Limits: a bench too many takes the place of the one that has been gone for longest;
// when none is, its messages are counted and left out. Of runs the ones that are over and oldest
// make way. Events are what changed while it was listened to.
//
// Belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"
#include "services/bus/host_clocks/clock_asker.hpp"
#include "services/network/bench.hpp"
#include "services/network/limits.hpp"

namespace dyncal::network {

class BusState {
public:
  // `clock` outlives the object.
  explicit BusState(bus::Clock& clock, Limits limits = {}) : clock_(clock), limits_(limits) {}

  void take(const wire::SourceDescription& message);
  void take(const wire::SourceStatus& message);
  void take(const wire::Measurement& message);
  void take(const wire::Excitation& message);
  void take(const wire::CalibrationResult& message);
  void take(const wire::TransferFunction& message);
  void take(const wire::SampleClockReport& message);
  void take(const wire::ServiceStatus& message);
  // From the topic of recorders, whose writers speak for no other service, and of no run.
  void take_of_recorder(wire::ServiceStatus message);
  // Those that answer now, and the clocks of their hosts.
  void set_programs(std::vector<DiscoveredProgram> programs, std::vector<HostClock> clocks);
  // What time alone changes.
  void work();

  // By name.
  [[nodiscard]] const std::map<std::string, Bench>& benches() const { return benches_; }
  // Null: not known.
  [[nodiscard]] const Bench* bench(const std::string& name) const;
  [[nodiscard]] const std::vector<DiscoveredProgram>& programs() const { return programs_; }
  // One a host that is not ours, in alphabetical order.
  [[nodiscard]] const std::vector<HostClock>& clocks() const { return clocks_; }
  // Nothing: it is this host, or not known.
  [[nodiscard]] std::optional<ClockOffset> clock_of(const std::string& host) const;
  // The one that is off most, of the hosts of the bench's sources and services.
  [[nodiscard]] std::optional<ClockOffset> worst_clock(const Bench& bench) const;
  // Of all benches by time, the newest last, at most Limits::events.
  [[nodiscard]] std::vector<Event> events() const;
  [[nodiscard]] const LeftOut& left_out() const { return left_out_; }
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] bus::Clock& clock() const { return clock_; }

private:
  Bench* bench_of(const std::string& name);
  bool make_room_for_bench();
  Source* source_of(Bench& bench, const std::string& name);
  Run* run_of(Bench& bench, const std::string& name);
  bool make_room_for_run(Bench& bench);
  bool make_room_for_result(const Run& run);
  bool drop_results_of_oldest(const Run& run);
  void take_service(Bench& bench, const wire::ServiceStatus& message);
  void note(Bench& bench, Severity severity, const std::string& text);
  void note(Bench& bench, const std::vector<Condition>& changes);
  void changed(Bench& bench) { bench.number = ++number_; }
  void results_changed(Run& run) { run.results_number = ++results_number_; }
  [[nodiscard]] std::size_t results() const;

  bus::Clock& clock_;
  Limits limits_;
  std::map<std::string, Bench> benches_;
  std::vector<DiscoveredProgram> programs_;
  std::vector<HostClock> clocks_;
  LeftOut left_out_;
  std::uint64_t number_ = 0;
  std::uint64_t results_number_ = 0; // of all runs
  std::uint64_t runs_heard_ = 0;
};

} // namespace dyncal::network
