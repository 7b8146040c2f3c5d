#include "services/daemon/program/network_changes.hpp"

#include <array>
#include <cerrno>
#include <linux/rtnetlink.h>
#include <sys/socket.h>
#include <unistd.h>

namespace dyncal::inline daemon {
namespace {

int listen_to_kernel() {
  const int announcements =
      socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE);
  sockaddr_nl groups{};
  groups.nl_family = AF_NETLINK;
  groups.nl_groups = RTMGRP_LINK | RTMGRP_IPV4_IFADDR;
  if (announcements >= 0 &&
      bind(announcements, reinterpret_cast<sockaddr*>(&groups), sizeof groups) != 0) {
    close(announcements);
    return -1;
  }
  return announcements;
}

} // namespace

NetworkChanges::NetworkChanges() : socket_(listen_to_kernel()) {}

NetworkChanges::~NetworkChanges() {
  if (socket_ >= 0) {
    close(socket_);
  }
}

bool NetworkChanges::any() {
  if (socket_ < 0) {
    return true;
  }
  bool changed = false;
  std::array<char, 8192> message{}; // what does not fit is not read
  ssize_t count = 0;
  while ((count = recv(socket_, message.data(), message.size(), 0)) > 0) {
    changed = true;
  }
  return changed || (count < 0 && errno != EAGAIN && errno != EINTR);
}

} // namespace dyncal::inline daemon
