#include "drivers/can/bus/link_transition.hpp"

namespace dyncal::drivers::can {

LinkTransition transition_between(const LinkState& before, const LinkState& now, Binding binding) {
  if (before.present && !now.present) {
    return LinkTransition::gone;
  }
  if (binding == Binding::refused) {
    return LinkTransition::unusable;
  }
  if (now.present && (binding == Binding::renewed || !before.present)) {
    return LinkTransition::back;
  }
  if (now.up != before.up) {
    return now.up ? LinkTransition::up : LinkTransition::down;
  }
  if (now.carrier != before.carrier) {
    return now.carrier ? LinkTransition::bus_regained : LinkTransition::bus_lost;
  }
  if (now.bus == BusState::bus_off && before.bus != BusState::bus_off) {
    return LinkTransition::bus_off;
  }
  return now.name == before.name ? LinkTransition::none : LinkTransition::renamed;
}

bool interrupts(LinkTransition transition) {
  return transition != LinkTransition::none && transition != LinkTransition::renamed;
}

std::string describe(LinkTransition transition, const LinkState& before, const LinkState& now) {
  const std::string interface = "interface '" + now.name + "' ";
  switch (transition) {
  case LinkTransition::none:
    break;
  case LinkTransition::gone:
    return "interface '" + before.name + "' has gone";
  case LinkTransition::unusable:
    return interface + "is there but cannot be opened";
  case LinkTransition::back:
    return interface + "is back";
  case LinkTransition::up:
    return interface + "is up";
  case LinkTransition::down:
    return interface + "is down";
  case LinkTransition::bus_regained:
    return interface + "has its bus back";
  case LinkTransition::bus_lost:
    return interface + "lost its bus";
  case LinkTransition::bus_off:
    return "bus-off";
  case LinkTransition::renamed:
    return "interface '" + before.name + "' is now called '" + now.name + "'";
  }
  return "";
}

} // namespace dyncal::drivers::can
