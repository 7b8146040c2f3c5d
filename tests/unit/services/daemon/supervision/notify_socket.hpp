// The other end of NOTIFY_SOCKET: what systemd hears of a program. For tests. One thread.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace dyncal::tests {

class NotifySocket {
public:
  // Binds a socket in `folder`, and names it in the environment of this process and those that it
  // starts, with the time that the watchdog gives.
  NotifySocket(const std::string& folder, std::chrono::microseconds watchdog)
      : descriptor_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string path = folder + "/notify";
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof(address.sun_path)) {
      throw std::runtime_error("too long for a socket: " + path);
    }
    std::memcpy(address.sun_path, path.data(), path.size());
    unlink(path.c_str());
    if (bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
      throw std::runtime_error("cannot bind " + path);
    }
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", std::to_string(watchdog.count()).c_str(), 1);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(descriptor_);
  }

  // The next datagram; empty if none came within that time.
  [[nodiscard]] std::string next(std::chrono::milliseconds limit = std::chrono::milliseconds(0)) {
    pollfd readable{descriptor_, POLLIN, 0};
    if (poll(&readable, 1, static_cast<int>(limit.count())) <= 0) {
      return "";
    }
    std::array<char, 4096> buffer{};
    const ssize_t size = recv(descriptor_, buffer.data(), buffer.size(), 0);
    return {buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
  }

private:
  int descriptor_;
};

} // namespace dyncal::tests
