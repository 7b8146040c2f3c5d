// What tests on a real CAN kernel need: links made and removed with iproute2, a socket to send
// frames with, and what a source hears of them.
#pragma once

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "tests/patience.hpp"

namespace dyncal::tests {

inline constexpr std::int64_t second_ns = 1'000'000'000;

inline std::int64_t now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * second_ns + now.tv_nsec;
}

inline void ip(const std::string& arguments) {
  if (std::system(("ip link " + arguments).c_str()) != 0) {
    throw std::runtime_error("ip link " + arguments);
  }
}

// A virtual interface for the time of a test. FD frames pass.
class VirtualCan {
public:
  explicit VirtualCan(std::string name) : name_(std::move(name)) {
    ip("add " + name_ + " type vcan");
    ip("set " + name_ + " mtu 72 up");
  }
  ~VirtualCan() {
    static_cast<void>(std::system(("ip link del " + name_ + " 2>/dev/null").c_str()) < 0);
  }
  VirtualCan(const VirtualCan&) = delete;
  VirtualCan& operator=(const VirtualCan&) = delete;

private:
  std::string name_;
};

class Sender {
public:
  explicit Sender(const std::string& interface_name)
      : socket_(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
    const int on = 1;
    ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
    ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface_name.c_str()));
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("bind " + interface_name);
    }
  }
  ~Sender() { ::close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  // `id` with the kernel's flag bits.
  bool send(std::uint32_t id, const std::vector<std::uint8_t>& data, bool fd = false) {
    canfd_frame frame{};
    frame.can_id = id;
    frame.len = static_cast<std::uint8_t>(data.size());
    frame.flags = fd ? CANFD_BRS : 0;
    std::memcpy(frame.data, data.data(), data.size());
    const std::size_t size = fd ? CANFD_MTU : CAN_MTU;
    return ::write(socket_, &frame, size) == static_cast<ssize_t>(size);
  }

private:
  int socket_;
};

using drivers::can::BusEvent;
using drivers::can::CanFrame;
using drivers::can::FrameSource;

inline drivers::can::SocketCanSettings on(const std::string& interface_name) {
  drivers::can::SocketCanSettings settings;
  settings.interface_name = interface_name;
  return settings;
}

// Reads until `enough`, or until patience ends; what was read.
inline std::vector<BusEvent>
read_until(FrameSource& source, const std::function<bool(const std::vector<BusEvent>&)>& enough) {
  std::vector<BusEvent> events;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!enough(events) && std::chrono::steady_clock::now() < deadline) {
    static_cast<void>(source.read(events, std::chrono::milliseconds(20)));
  }
  return events;
}

inline std::vector<CanFrame> frames_of(const std::vector<BusEvent>& events) {
  std::vector<CanFrame> frames;
  for (const BusEvent& event : events) {
    if (const auto* frame = std::get_if<CanFrame>(&event)) {
      frames.push_back(*frame);
    }
  }
  return frames;
}

// For read_until().
inline auto frames(std::size_t wanted) {
  return
      [wanted](const std::vector<BusEvent>& events) { return frames_of(events).size() >= wanted; };
}

// Every change and fault so far, in words.
inline std::string told(const std::vector<BusEvent>& events) {
  std::string all;
  for (const BusEvent& event : events) {
    if (const auto* change = std::get_if<drivers::can::LinkChange>(&event)) {
      all += change->what + "; ";
    }
    if (const auto* fault = std::get_if<drivers::can::BusFault>(&event)) {
      all += fault->cause + "; ";
    }
  }
  return all;
}

inline auto says(const std::string& words) {
  return [words](const std::vector<BusEvent>& events) {
    return told(events).find(words) != std::string::npos;
  };
}

} // namespace dyncal::tests
