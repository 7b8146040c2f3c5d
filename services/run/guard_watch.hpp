// Whether a dyncal-guard watches over the exciter that a run drives, by what guards say of
// themselves (ServiceStatus with a `guarded_generator`, every second).
//
// A run without one goes on, for its conductor switches the output off whenever it can; but the
// exciter of a conductor whose host or link fails would stay on, so that the operator is told: when
// none is heard within `limit` of the beginning, when the last one falls silent, and when one
// guards another generator (services/bench/file/generator_address.hpp). What a guard says of an
// output that it cannot switch off is passed on, whatever others say. A run that a guard names is
// one that it does not hear while it hears the guard: that run pauses until it is heard. Belongs to
// one thread.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"

namespace dyncal::inline run {

class GuardWatch {
public:
  using Instant = bus::Clock::Instant;

  static constexpr std::chrono::seconds limit{5};
  static constexpr std::size_t max_guards = 16; // of a bench, which needs one

  // `generator`: the address that the run drives; empty: none that a guard could switch off, and
  // nothing is told.
  GuardWatch(std::string bench, std::string generator, Instant now)
      : bench_(std::move(bench)), generator_(std::move(generator)), since_(now) {}

  // Of a guard; others are passed over.
  void take(const wire::ServiceStatus& status, Instant now);
  // What the operator is to know now, once until it changes.
  [[nodiscard]] std::optional<std::string> notice(Instant now);

  // What a guard of this generator says of an output that may be on; empty: none says so.
  [[nodiscard]] std::string failure(Instant now) const;

  // Which guard of this generator does not hear `run`, as a sentence; empty: none says so.
  [[nodiscard]] std::string deafness(const std::string& run, Instant now) const;

private:
  struct Guard {
    std::string host;
    std::string unheard; // the run that it does not hear
    std::string generator;
    std::string message; // of one that cannot switch off
    Instant heard;
  };

  // Empty: none, or not known yet.
  [[nodiscard]] std::string lack(Instant now) const;

  std::string bench_;
  std::string generator_;
  Instant since_;
  std::map<std::string, Guard> guards_; // by service
  std::string last_notice_;             // the lack that was told last
};

} // namespace dyncal::inline run
