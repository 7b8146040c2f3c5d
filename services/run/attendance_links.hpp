// What a conductor shows dyncal-guard in its messages about a run, so that nobody else's count: a
// one-way chain (services/contract/one_way_chain.hpp) for Measurement and one for Excitation, since
// topics have no order among each other. Measurement announces the end of Excitation's.
//
// The chains last for `longest_attendance` of a run that is paused or excited all the time. After
// that there are no links any more, the guard hears nothing, and the run pauses and ends. A new
// chain is no way out: a guard takes none while the run lives. One thread.
#pragma once

#include <chrono>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/contract/one_way_chain.hpp"

namespace dyncal::inline run {

class AttendanceLinks {
public:
  static constexpr std::chrono::hours longest_attendance{14 * 24};

  // Takes some 0.5 s of a processor. Fails (device) where the system gives no random numbers.
  [[nodiscard]] static Expected<AttendanceLinks>
  draw(std::chrono::hours attendance = longest_attendance); // shorter in tests

  // The next link into the message; none when all have been shown.
  void show(wire::Measurement& measurement);
  void show(wire::Excitation& excitation);

private:
  AttendanceLinks(OneWayChain measurement, OneWayChain excitation)
      : measurement_(std::move(measurement)), excitation_(std::move(excitation)) {}

  OneWayChain measurement_;
  OneWayChain excitation_;
};

} // namespace dyncal::inline run
