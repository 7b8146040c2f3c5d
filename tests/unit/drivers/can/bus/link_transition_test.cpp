#include "drivers/can/bus/link_transition.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::can {
namespace {

LinkState running() {
  LinkState link;
  link.name = "can0";
  link.present = link.up = link.carrier = true;
  link.bus = BusState::error_active;
  return link;
}

LinkState absent() {
  LinkState link;
  link.name = "can0";
  return link;
}

TEST(LinkTransition, IsNoneWhereOnlyCountersChange) {
  LinkState now = running();
  now.receive_errors = 3;
  EXPECT_EQ(transition_between(running(), now, Binding::kept), LinkTransition::none);
  EXPECT_EQ(transition_between(absent(), absent(), Binding::kept), LinkTransition::none);
  EXPECT_FALSE(interrupts(LinkTransition::none));
  EXPECT_EQ(describe(LinkTransition::none, running(), now), "");
}

TEST(LinkTransition, FollowsAnInterfaceThatGoesAndComesBack) {
  EXPECT_EQ(transition_between(running(), absent(), Binding::kept), LinkTransition::gone);
  EXPECT_EQ(transition_between(absent(), running(), Binding::renewed), LinkTransition::back);
  EXPECT_EQ(transition_between(absent(), running(), Binding::kept), LinkTransition::back);
  EXPECT_EQ(transition_between(absent(), running(), Binding::refused), LinkTransition::unusable);
  // Unplugged and plugged in again between two announcements.
  EXPECT_EQ(transition_between(running(), running(), Binding::renewed), LinkTransition::back);
}

TEST(LinkTransition, TellsTheInterfaceFromItsBus) {
  LinkState down = running();
  down.up = down.carrier = false;
  EXPECT_EQ(transition_between(running(), down, Binding::kept), LinkTransition::down);
  EXPECT_EQ(transition_between(down, running(), Binding::kept), LinkTransition::up);

  LinkState without_bus = running();
  without_bus.carrier = false;
  EXPECT_EQ(transition_between(running(), without_bus, Binding::kept), LinkTransition::bus_lost);
  EXPECT_EQ(transition_between(without_bus, running(), Binding::kept),
            LinkTransition::bus_regained);

  LinkState off = running();
  off.bus = BusState::bus_off;
  EXPECT_EQ(transition_between(running(), off, Binding::kept), LinkTransition::bus_off);
  EXPECT_EQ(transition_between(off, off, Binding::kept), LinkTransition::none);
  EXPECT_EQ(transition_between(off, running(), Binding::kept), LinkTransition::none);
}

TEST(LinkTransition, OfANameAloneMissesNoFrames) {
  LinkState renamed = running();
  renamed.name = "shaker0";
  EXPECT_EQ(transition_between(running(), renamed, Binding::kept), LinkTransition::renamed);
  EXPECT_FALSE(interrupts(LinkTransition::renamed));
  EXPECT_EQ(describe(LinkTransition::renamed, running(), renamed),
            "interface 'can0' is now called 'shaker0'");

  renamed.up = false; // what may have cost frames counts before the name
  EXPECT_EQ(transition_between(running(), renamed, Binding::kept), LinkTransition::down);
  EXPECT_EQ(describe(LinkTransition::down, running(), renamed), "interface 'shaker0' is down");
}

TEST(LinkTransition, NamesWhatMayHaveCostFrames) {
  for (const LinkTransition transition :
       {LinkTransition::gone, LinkTransition::unusable, LinkTransition::back, LinkTransition::up,
        LinkTransition::down, LinkTransition::bus_regained, LinkTransition::bus_lost,
        LinkTransition::bus_off}) {
    EXPECT_TRUE(interrupts(transition));
    EXPECT_NE(describe(transition, running(), running()), "");
  }
}

} // namespace
} // namespace dyncal::drivers::can
