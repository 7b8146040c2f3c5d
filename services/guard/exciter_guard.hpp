// Switches the exciter of a bench off when nobody attends a run any more: on the bench's side,
// where the generator can be reached although the conductor's link, host or program is gone.
//
// The exciter is driven while the newest Excitation of a run has no end of its window. The
// conductor repeats it every half second while it has hold of the generator (idl/README.md, "The
// run protocol"); nothing heard for `unattended_limit` means that nobody attends, whatever else is
// heard of the run. Then the output is switched off, and tried again every `retry_interval` until
// that is confirmed, or the conductor is heard again. It is done once for each silence: a conductor
// that comes back finds the output off and repeats the step.
//
// It says every second that it is there and which generator it guards (ServiceStatus), and whether
// an output may be on that it cannot reach: `dyncal run` tells its operator where no guard is
// heard.
//
// `switch_off` returns when the output is known to be off, and may block for seconds; the guard of
// one bench therefore has a thread of its own, the only one that uses it.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/contract/program_identity.hpp"
#include "services/supervision/daemon_metrics.hpp"

namespace dyncal::services {

struct GuardedExciter {
  std::string bench;
  std::string generator; // its address
};

class ExciterGuard {
public:
  using Instant = bus::Clock::Instant;
  using SwitchOff = std::function<Expected<void>()>;

  static constexpr std::chrono::seconds retry_interval{1};
  static constexpr std::chrono::seconds report_interval{60}; // while it cannot be switched off
  static constexpr std::chrono::seconds status_interval{1};

  // `own`: the program that guards. `clock` outlives the guard. Fails (network) as readers and
  // writers do.
  [[nodiscard]] static Expected<std::unique_ptr<ExciterGuard>>
  create(bus::Participant& participant, const ProgramIdentity& own, const GuardedExciter& exciter,
         std::chrono::milliseconds unattended_limit, SwitchOff switch_off,
         bus::Clock& clock = bus::system_clock());

  // Until `stop` is requested. Calls `turned` at every turn of its loop, which a generator that
  // does not answer holds up.
  void serve(const std::stop_token& stop, const std::function<void()>& turned = {});
  // What is due now.
  void work();

  [[nodiscard]] GuardFigures figures() const;

private:
  struct Run {
    bool driven = false;
    bool served = false; // switched off since it was heard last
    Instant heard;
    Instant next_try{};
    Instant next_report{};
  };

  struct Endpoints {
    bus::Reader<wire::Excitation> excitation;
    bus::Writer<wire::ServiceStatus> status;
  };

  ExciterGuard(wire::ServiceStatus status, std::chrono::milliseconds unattended_limit,
               SwitchOff switch_off, bus::Clock& clock, std::shared_ptr<bus::WakeUp> wake_up,
               Endpoints endpoints)
      : bench_(status.bench().to_string()), unattended_limit_(unattended_limit),
        switch_off_(std::move(switch_off)), clock_(clock), wake_up_(std::move(wake_up)),
        endpoints_(std::move(endpoints)), status_(std::move(status)) {}

  void take_messages();
  Run& heard(const std::string& run);
  void attend(const std::string& name, Run& run);
  // Says so as soon as it has changed.
  void set_health(wire::HealthState health, const std::string& message);
  void publish();

  std::string bench_;
  std::chrono::milliseconds unattended_limit_;
  SwitchOff switch_off_;
  bus::Clock& clock_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  Endpoints endpoints_;
  wire::ServiceStatus status_; // as published last
  Instant next_status_{};
  std::map<std::string, Run> runs_;
  std::uint64_t times_switched_off_ = 0;
};

} // namespace dyncal::services
