// A CAN adapter on a serial line (LAWICEL protocol), played by a test: the kernel's slcan driver
// makes a CAN interface of a pseudo terminal, and the test says what the adapter would say. A
// thread of its own hears what the kernel tells the adapter, as the driver waits for that.
#pragma once

#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <linux/tty.h>
#include <net/if.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "tests/can/kernel_can.hpp"

namespace dyncal::tests {

class SerialAdapter {
public:
  // At 500 kbit/s; up.
  SerialAdapter() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0) {
      throw std::runtime_error("no pseudo terminal");
    }
    slave_ = ::open(::ptsname(master_), O_RDWR | O_NOCTTY);
    termios raw{};
    ::tcgetattr(slave_, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(slave_, TCSANOW, &raw);
    const int discipline = N_SLCAN;
    if (::ioctl(slave_, TIOCSETD, &discipline) != 0) {
      throw std::runtime_error("this kernel has no slcan");
    }
    char name[IFNAMSIZ] = "";
    ::ioctl(slave_, SIOCGIFNAME, name);
    name_ = name;
    listener_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
    ip("set " + name_ + " type can bitrate 500000");
    ip("set " + name_ + " up");
  }
  ~SerialAdapter() { unplug(); }
  SerialAdapter(const SerialAdapter&) = delete;
  SerialAdapter& operator=(const SerialAdapter&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }

  // One message of the adapter, e.g. "t1232AABB".
  void say(const std::string& message) {
    const std::string line = message + "\r";
    if (::write(master_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
      throw std::runtime_error("pseudo terminal is full");
    }
  }

  // Everything the kernel has told the adapter since the last call.
  std::string heard() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(heard_, {});
  }

  void unplug() {
    listener_ = {};
    if (master_ >= 0) {
      ::close(master_);
    }
    if (slave_ >= 0) {
      ::close(slave_);
    }
    master_ = slave_ = -1;
  }

private:
  void listen(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd waited{master_, POLLIN, 0};
      char some[512];
      if (::poll(&waited, 1, 20) <= 0) {
        continue;
      }
      const ssize_t got = ::read(master_, some, sizeof some);
      if (got <= 0) {
        return;
      }
      const std::scoped_lock lock(mutex_);
      heard_.append(some, static_cast<std::size_t>(got));
    }
  }

  int master_;
  int slave_ = -1;
  std::string name_;
  std::mutex mutex_;
  std::string heard_;
  std::jthread listener_;
};

} // namespace dyncal::tests
