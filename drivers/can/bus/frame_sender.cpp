#include "drivers/can/bus/frame_sender.hpp"

#include <cerrno>
#include <cstring>

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

namespace dyncal::drivers::can {

Expected<FrameSender> FrameSender::open(const std::string& interface_name) {
  FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
  if (!socket.is_open()) {
    return fail(ErrorCode::refused,
                interface_name + ": this kernel has no CAN sockets (" + std::strerror(errno) +
                    "); 'modprobe can-raw', or use a kernel with CONFIG_CAN_RAW");
  }
  const unsigned index = ::if_nametoindex(interface_name.c_str());
  if (index == 0) {
    return fail(ErrorCode::not_found, "there is no interface '" + interface_name +
                                          "'; 'ip link add " + interface_name +
                                          " type vcan' and 'ip link set " + interface_name +
                                          " mtu 72 up' make a virtual one");
  }
  const int on = 1;
  ::setsockopt(socket.number(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
  ::setsockopt(socket.number(), SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return fail(ErrorCode::refused, "interface '" + interface_name + "' is not a CAN interface (" +
                                        std::strerror(errno) + ")");
  }
  return FrameSender(interface_name, std::move(socket));
}

Expected<void> FrameSender::send(const CanFrame& frame) {
  canfd_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
  raw.len = frame.length;
  raw.flags = static_cast<std::uint8_t>((frame.bit_rate_switch ? CANFD_BRS : 0) |
                                        (frame.error_state_indicator ? CANFD_ESI : 0));
  std::memcpy(raw.data, frame.data.data(), frame.length);
  const std::size_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  if (::write(socket_.number(), &raw, size) == static_cast<ssize_t>(size)) {
    return {};
  }
  const bool too_long = errno == EINVAL && frame.fd;
  return fail(ErrorCode::refused,
              "interface '" + interface_name_ + "' does not accept the frame (" +
                  std::strerror(errno) + "); " +
                  (too_long ? "FD frames need 'ip link set " + interface_name_ + " mtu 72'"
                            : "is it up? 'ip link set " + interface_name_ + " up'"));
}

} // namespace dyncal::drivers::can
