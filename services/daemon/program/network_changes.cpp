#include "services/daemon/program/network_changes.hpp"

#include <array>
#include <cerrno>
#include <linux/rtnetlink.h>
#include <sys/socket.h>

namespace dyncal::services {
namespace {

drivers::FileDescriptor listen_to_kernel() {
  drivers::FileDescriptor announcements(
      socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE));
  sockaddr_nl groups{};
  groups.nl_family = AF_NETLINK;
  groups.nl_groups = RTMGRP_LINK | RTMGRP_IPV4_IFADDR;
  if (bind(announcements.number(), reinterpret_cast<sockaddr*>(&groups), sizeof groups) != 0) {
    announcements.reset();
  }
  return announcements;
}

} // namespace

NetworkChanges::NetworkChanges() : announcements_(listen_to_kernel()) {}

bool NetworkChanges::any() {
  if (!announcements_.is_open()) {
    return true;
  }
  bool changed = false;
  std::array<char, 8192> message{}; // what does not fit is not read
  ssize_t count = 0;
  while ((count = recv(announcements_.number(), message.data(), message.size(), 0)) > 0) {
    changed = true;
  }
  return changed || (count < 0 && errno != EAGAIN && errno != EINTR);
}

} // namespace dyncal::services
