// A DDS domain that no other test of this machine has, in whichever build tree: tests that run side
// by side neither hear of each other nor compete for ports.
//
// A name in the abstract namespace of Unix sockets stands for each domain. The kernel gives it to
// one process at a time, frees it when the process ends however it ends, and keeps it apart by
// network namespace, as the domain itself. Any thread.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace dyncal::tests {

// Returns true if the name was free; it is this process's from then on.
inline bool reserve_for_this_process(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string whole = "dyncal-test-" + name;
  std::copy(whole.begin(), whole.end(), address.sun_path + 1); // the leading 0 makes it abstract
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + whole.size());
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), length) == 0) {
    return true; // the descriptor stays open for as long as the process
  }
  close(descriptor);
  return false;
}

// The same at every call of a process.
inline int own_dds_domain() {
  // Of those whose ports (7400 + 250 a domain) are below the ones that the kernel hands out.
  constexpr int first_domain = 1;
  constexpr int last_domain = 100;
  static const int domain = [] {
    constexpr int domains = last_domain - first_domain + 1;
    for (int i = 0; i < domains; ++i) {
      const int candidate = first_domain + (static_cast<int>(getpid()) + i) % domains;
      if (reserve_for_this_process("dds-domain-" + std::to_string(candidate))) {
        return candidate;
      }
    }
    throw std::runtime_error("every DDS domain for tests is in use");
  }();
  return domain;
}

} // namespace dyncal::tests
