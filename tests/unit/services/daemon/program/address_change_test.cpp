#include "services/daemon/program/address_change.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline daemon {
namespace {

using bus::HostAddress;
using Addresses = std::vector<HostAddress>;

const HostAddress loopback{"lo", 1, "127.0.0.1", true, false};
const HostAddress lab{"lab", 2, "10.98.0.1", false, false};
const HostAddress lab_later{"lab", 2, "10.98.0.7", false, false};
const HostAddress lab_plugged_in_again{"lab", 5, "10.98.0.1", false, false};
const HostAddress office{"office", 3, "10.20.0.1", false, false};
const HostAddress office_later{"office", 3, "10.20.0.9", false, false};
const HostAddress containers{"docker0", 4, "172.17.0.1", false, true};
const HostAddress containers_later{"docker0", 4, "172.18.0.1", false, true};

std::string what_deafens(const Addresses& start, std::vector<std::string> announced,
                         const Addresses& now) {
  return daemon::what_deafens(AddressesAtStart{start, std::move(announced)}, now);
}

TEST(AddressChange, DeafensWhenTheAddressMakesWayForAnother) {
  EXPECT_EQ(what_deafens({loopback, lab}, {"10.98.0.1"}, {loopback, lab_later}),
            "the address of this host was 10.98.0.1 (lab) and is 10.98.0.7 (lab) now");
  EXPECT_NE(what_deafens({lab, office}, {"10.98.0.1", "10.20.0.1"}, {lab_later, office}), "");
  EXPECT_NE(what_deafens({lab}, {"10.98.0.1"}, {office}), "") << "from cable to wireless";
  EXPECT_NE(what_deafens({lab, containers}, {"10.98.0.1", "172.17.0.1"}, {office, containers}), "");
}

TEST(AddressChange, DeafensWhenTheFirstAddressComesLate) {
  EXPECT_EQ(what_deafens({loopback}, {"127.0.0.1"}, {loopback, lab}),
            "this host has got its address 10.98.0.1 (lab) after the program was started");
  EXPECT_NE(what_deafens({loopback, containers}, {"172.17.0.1"}, {loopback, containers, lab}), "");
}

TEST(AddressChange, DeafensWhenTheInterfaceIsPluggedInAgain) {
  EXPECT_EQ(what_deafens({loopback, lab}, {"10.98.0.1"}, {loopback, lab_plugged_in_again}),
            "the interface lab of this host was taken away and has come back");
}

TEST(AddressChange, DoesNotDeafenWhenAnAddressIsGoneOrComesBackAsItWas) {
  EXPECT_EQ(what_deafens({loopback, lab}, {"10.98.0.1"}, {loopback}), "");
  EXPECT_EQ(what_deafens({loopback, lab}, {"10.98.0.1"}, {loopback, lab}), "");
  EXPECT_EQ(what_deafens({lab, office}, {"10.98.0.1"}, {office}), "") << "it was there before";
}

TEST(AddressChange, DoesNotDeafenByWhatIsNotAnnounced) {
  EXPECT_EQ(what_deafens({lab}, {"10.98.0.1"}, {lab, office}), "");
  EXPECT_EQ(what_deafens({lab}, {"10.98.0.1"}, {lab, lab_later}), "") << "a second address";
  EXPECT_EQ(what_deafens({lab}, {"10.98.0.1"}, {lab, containers}), "");
  EXPECT_EQ(what_deafens({loopback}, {"127.0.0.1"}, {loopback, containers}), "");
  EXPECT_EQ(what_deafens({lab, office}, {"10.98.0.1"}, {lab, office_later}), "");
  EXPECT_EQ(what_deafens({lab, containers}, {"10.98.0.1", "172.17.0.1"}, {lab, containers_later}),
            "");
}

TEST(AddressChange, WaitsUntilTheParticipantHasSaidWhatItAnnounces) {
  EXPECT_EQ(what_deafens({lab}, {}, {lab_later}), "");
}

TEST(AddressChange, SaysWhatHasGoneAndWhatHasCome) {
  EXPECT_EQ(difference({loopback, lab}, {loopback, lab}), "");
  EXPECT_EQ(difference({loopback, lab}, {loopback, lab_later, containers}),
            "10.98.0.1 (lab) is gone, 10.98.0.7 (lab) has come, 172.17.0.1 (docker0) has come");
}

} // namespace
} // namespace dyncal::inline daemon
