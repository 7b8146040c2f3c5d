// Whether an interface or an IPv4 address of this host has changed, as the kernel announces it
// (rtnetlink), so that nobody has to list them all twice a second.
//
// Where the kernel cannot be asked, or has announced more than its buffer holds, something has
// changed. Of the network namespace in which the object was made. One thread.
#pragma once

#include <utility>

namespace dyncal::inline daemon {

class NetworkChanges {
public:
  NetworkChanges();
  ~NetworkChanges();
  NetworkChanges(NetworkChanges&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  NetworkChanges& operator=(NetworkChanges&&) = delete;
  NetworkChanges(const NetworkChanges&) = delete;
  NetworkChanges& operator=(const NetworkChanges&) = delete;

  // Since the last call, or since the object was made.
  [[nodiscard]] bool any();

private:
  int socket_; // -1: the kernel cannot be asked
};

} // namespace dyncal::inline daemon
