// Switches the exciter of a bench off when nobody attends a run any more: on the bench's side,
// where the generator can be reached although the conductor's link, host or program is gone.
//
// The exciter is driven while the newest Excitation of a run has no end of its window. The
// conductor repeats it every half second while it has hold of the generator (idl/README.md, "The
// run protocol"); nothing heard for ExciterWatch::unattended_limit means that nobody attends,
// whatever else is heard of the run. Whose Excitations count: believed_conductor.hpp. A run that
// drives the exciter and is not that conductor's is named like one that is not heard. What is done
// then, and what the generator is asked for, stands
// in exciter_watch.hpp; here are the bus, the generator, the record and the log. What the reference
// shows of an exciter that goes on although its generator answers that it is off:
// reference_watch.hpp.
//
// It says every second that it is there and which generator it guards (ServiceStatus), whether an
// output may be on that it cannot switch off (FAILED), and in `run` which run it does not hear:
// that run pauses, for it drives unguarded. `dyncal run` tells its operator where no guard is
// heard.
//
// Switching off may block for seconds; the guard of one bench therefore has a thread of its own,
// the only one that uses it.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/contract/program_identity.hpp"
#include "services/daemon/supervision/daemon_metrics.hpp"
#include "services/programs/guard/believed_conductor.hpp"
#include "services/programs/guard/driven_record.hpp"
#include "services/programs/guard/exciter_watch.hpp"
#include "services/programs/guard/guarded_output.hpp"
#include "services/programs/guard/reference_watch.hpp"

namespace dyncal::inline programs {

struct GuardedExciter {
  std::string bench;
  std::string generator;                  // its address
  std::vector<OutputSettings> planned;    // by the bench file
  double level_per_volt = 1.0;            // m/s^2 per V
  bool has_closed_loop = false;           // of the level: the voltage is not known before
  std::optional<ChannelName> reference{}; // where an ACS records it
};

class ExciterGuard {
public:
  using Instant = bus::Clock::Instant;

  static constexpr std::chrono::seconds report_interval{60}; // while it cannot be switched off
  static constexpr std::chrono::seconds status_interval{1};
  // What a program says before it may conduct counts once it may: who resumes a run says once that
  // the step that was driven is over.
  static constexpr std::chrono::seconds passed_over_for{5};

  // `own`: the program that guards. `clock` outlives the guard. Fails (network) as readers and
  // writers do.
  [[nodiscard]] static Expected<std::unique_ptr<ExciterGuard>>
  create(bus::Participant& participant, const ProgramIdentity& own, const GuardedExciter& exciter,
         std::unique_ptr<GuardedOutput> output, DrivenRecord record,
         bus::Clock& clock = bus::system_clock());

  // Until `stop` is requested. Calls `turned` at every turn of its loop, which a generator that
  // does not answer holds up.
  void serve(const std::stop_token& stop, const std::function<void()>& turned = {});
  // What is due now.
  void work();

  [[nodiscard]] GuardFigures figures() const;

private:
  struct Endpoints {
    bus::Reader<wire::Excitation> excitation;
    bus::Reader<wire::Measurement> measurement;
    bus::Writer<wire::ServiceStatus> status;
    std::shared_ptr<bus::WakeUp> wake_up; // of the readers
  };

  ExciterGuard(wire::ServiceStatus status, GuardedExciter exciter, ExciterWatch watch,
               std::optional<ReferenceWatch> reference, std::unique_ptr<GuardedOutput> output,
               DrivenRecord record, bus::Clock& clock, Endpoints endpoints)
      : exciter_(std::move(exciter)), watch_(std::move(watch)),
        conductor_(record.read_conductor(), clock.now()), reference_(std::move(reference)),
        output_(std::move(output)), record_(std::move(record)), clock_(clock),
        endpoints_(std::move(endpoints)), status_(std::move(status)), recorded_(watch_.run()) {}

  void take_messages();
  void take(const wire::Measurement& measurement, const bus::WriterId& writer);
  void take(const wire::Excitation& excitation, const bus::WriterId& writer);
  void heard(const wire::Excitation& excitation);
  void take_passed_over();
  [[nodiscard]] bool may_conductor_change() const;
  [[nodiscard]] std::string unheard_run() const;
  void act();
  void look_at_reference();
  [[nodiscard]] bool is_between_steps() const;
  void keep_record();
  void report();
  void publish();
  [[nodiscard]] OutputSettings settings_of(const wire::Excitation& excitation) const;
  [[nodiscard]] bool may_be_on() const;
  [[nodiscard]] std::string message() const;

  // Of another program than the conductor.
  struct PassedOver {
    wire::Excitation excitation;
    bus::WriterId writer;
    Instant at{};
  };
  struct OtherRun {
    std::string run; // drives, or is about to
    Instant heard{};
  };

  GuardedExciter exciter_;
  ExciterWatch watch_;
  BelievedConductor conductor_;
  std::optional<PassedOver> passed_over_;
  OtherRun other_run_;
  std::uint64_t passed_over_said_ = 0;
  Instant next_passed_over_{};
  std::optional<ReferenceWatch> reference_;
  std::unique_ptr<GuardedOutput> output_;
  DrivenRecord record_;
  bus::Clock& clock_;
  Endpoints endpoints_;
  wire::ServiceStatus status_; // as published last
  DrivenRun recorded_;
  std::string watched_run_; // in the log
  bool record_failed_ = false;
  Instant next_status_{};
  Instant next_report_{};
  std::uint64_t times_switched_off_ = 0;
};

} // namespace dyncal::inline programs
