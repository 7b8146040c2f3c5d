// What an announcement of the kernel means for a source that is bound to a CAN interface.
//
//   present -> absent                      gone
//   another interface of that name, bound  back            (also when it was absent before)
//   the same, but it cannot be opened      unusable
//   up <-> down                            up, down
//   carrier gained or lost                 bus_regained, bus_lost
//   any state -> bus-off                   bus_off
//   another name                           renamed
//
// The first line that applies counts: a change may be several at once. In all of them but the last
// frames may have been missed. Pure functions; any thread.
#pragma once

#include <string>

#include "drivers/can/bus/frame_source.hpp"

namespace dyncal::drivers::can {

// Of the source's socket to the interface that the announcement is about.
enum class Binding {
  kept,    // it is the interface that the socket was bound to
  renewed, // another one, which the socket is bound to now
  refused  // another one, which it cannot be bound to
};

enum class LinkTransition {
  none,
  gone,
  unusable,
  back,
  up,
  down,
  bus_regained,
  bus_lost,
  bus_off,
  renamed
};

[[nodiscard]] LinkTransition transition_between(const LinkState& before, const LinkState& now,
                                                Binding binding);

// Whether frames may have been missed.
[[nodiscard]] bool interrupts(LinkTransition transition);

// A sentence for the person at the bench, "" for none.
[[nodiscard]] std::string describe(LinkTransition transition, const LinkState& before,
                                   const LinkState& now);

} // namespace dyncal::drivers::can
