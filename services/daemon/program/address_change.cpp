#include "services/daemon/program/address_change.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::inline daemon {
namespace {

using bus::HostAddress;
using Addresses = std::vector<HostAddress>;

bool contains(const Addresses& addresses, const HostAddress& one) {
  return std::ranges::find(addresses, one) != addresses.end();
}

Addresses without(const Addresses& all, const Addresses& others) {
  Addresses rest;
  std::ranges::copy_if(all, std::back_inserter(rest),
                       [&](const HostAddress& one) { return !contains(others, one); });
  return rest;
}

Addresses outer(const Addresses& all) {
  Addresses rest;
  std::ranges::copy_if(all, std::back_inserter(rest),
                       [](const HostAddress& one) { return !one.loopback && !one.inner; });
  return rest;
}

Addresses announced(const AddressesAtStart& start) {
  Addresses used;
  std::ranges::copy_if(start.host, std::back_inserter(used), [&](const HostAddress& one) {
    return std::ranges::find(start.announced, one.address) != start.announced.end();
  });
  return outer(used);
}

} // namespace

std::string what_deafens(const AddressesAtStart& start, const std::vector<bus::HostAddress>& now) {
  const Addresses fresh = without(outer(now), start.host);
  if (start.announced.empty() || fresh.empty()) {
    return "";
  }
  const Addresses used = announced(start);
  if (used.empty()) {
    return fmt::format("this host has got its address {} after the program was started",
                       to_string(fresh.front()));
  }
  const Addresses gone = without(used, now);
  for (const HostAddress& one : gone) {
    const auto instead = std::ranges::find_if(fresh, [&](const HostAddress& other) {
      return gone.size() == used.size() || other.interface == one.interface;
    });
    if (instead == fresh.end()) {
      continue;
    }
    return instead->address == one.address
               ? fmt::format("the interface {} of this host was taken away and has come back",
                             one.interface)
               : fmt::format("the address of this host was {} and is {} now", to_string(one),
                             to_string(*instead));
  }
  return "";
}

std::string difference(const std::vector<bus::HostAddress>& before,
                       const std::vector<bus::HostAddress>& now) {
  std::string text;
  for (const HostAddress& one : without(before, now)) {
    text += fmt::format("{}{} is gone", text.empty() ? "" : ", ", to_string(one));
  }
  for (const HostAddress& one : without(now, before)) {
    text += fmt::format("{}{} has come", text.empty() ? "" : ", ", to_string(one));
  }
  return text;
}

} // namespace dyncal::inline daemon
