// What a change of this host's addresses is to a program that began with others.
//
// The participant of a program announces addresses when it is made, and others send to those as
// long as it lives. So it is deaf once none of them is there any more, or one of them has made way
// for another at the same interface, and an address has come that could be announced instead. It is
// not deaf when an address has come besides (a second network, containers, a tunnel), and there is
// nothing better to begin with when one is only gone: it may come back as it was.
//
// Bridges and tunnels count for a program that announces nothing else, until something else comes;
// loopback never does. An interface that was taken away and plugged in again is another one, also
// with the same address: the groups that were joined at it are forgotten. Plain functions.
#pragma once

#include <string>
#include <vector>

#include "services/bus/host_network.hpp"

namespace dyncal::inline daemon {

// When the participant was made.
struct AddressesAtStart {
  std::vector<bus::HostAddress> host;
  std::vector<std::string> announced; // empty: not known yet
};

// Why nobody hears the program, one part of a sentence; empty: somebody may.
[[nodiscard]] std::string what_deafens(const AddressesAtStart& start,
                                       const std::vector<bus::HostAddress>& now);

// "10.98.0.1 (lab) is gone, 10.98.0.7 (lab) has come"; empty where nothing has changed.
[[nodiscard]] std::string difference(const std::vector<bus::HostAddress>& before,
                                     const std::vector<bus::HostAddress>& now);

} // namespace dyncal::inline daemon
