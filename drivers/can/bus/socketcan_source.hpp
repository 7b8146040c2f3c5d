// Frames from a CAN interface of the Linux kernel (SocketCAN, classic and FD).
//
// One raw socket, read with recvmmsg: every frame comes with its kernel stamp, its hardware stamp
// where the adapter has one, and the count of frames that the socket had to drop, in the same call
// (SO_TIMESTAMPING, SO_RXQ_OVFL). The count of drops comes with the next frame after them: drops at
// the very end only show with one more frame. Error frames become BusFault, rtnetlink's
// announcements LinkChange.
//
// The source goes on after: interface down and up (the socket stays bound), interface gone (opened
// again as soon as one of the name exists), interface renamed (followed), bus-off (the kernel's or
// the adapter's own restart is waited for; with `restart_after_bus_off` the controller is restarted
// after that time, by IFLA_CAN_RESTART or, where the driver lacks it, by down and up). Each of
// these is a LinkChange with `interrupted` (link_transition.hpp); nothing is filled. Frames that
// waited to be read while the interface was down and up again come between two of them: on which
// side they belong is unknown.
//
// Fails at open() when the kernel has no CAN sockets; the interface does not exist, is not a CAN
// interface, or is down; or the user lacks the permission. Threads as FrameSource.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/can/bus/link_monitor.hpp"
#include "drivers/can/bus/link_transition.hpp"
#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers::can {

struct SocketCanSettings {
  std::string interface_name;
  // What the bus is meant to run at: the interface must agree. 0: whatever it runs at.
  std::uint32_t bit_rate_per_s = 0;
  std::uint32_t data_bit_rate_per_s = 0;
  std::optional<std::chrono::milliseconds> restart_after_bus_off;
  int receive_buffer_bytes = 8 << 20; // a frame takes about 800 bytes of it in the kernel
};

class SocketCanSource : public FrameSource {
public:
  explicit SocketCanSource(SocketCanSettings settings);
  ~SocketCanSource() override;

  [[nodiscard]] Expected<LinkState> open(const std::vector<FrameFilter>& filters) override;
  [[nodiscard]] Expected<ReadState> read(std::vector<BusEvent>& events,
                                         std::chrono::milliseconds limit) override;

private:
  struct Buffers;
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] Expected<void> check_link(const LinkState& link) const;
  [[nodiscard]] Expected<void> open_socket();
  [[nodiscard]] Expected<void> set_options(int socket) const;
  // True: the interface has gone down since the last call.
  [[nodiscard]] bool receive(std::vector<BusEvent>& events);
  void take(std::size_t message, std::vector<BusEvent>& events);
  void follow_link(const LinkMonitor::Change& announced, std::vector<BusEvent>& events);
  [[nodiscard]] Binding follow_interface(int index);
  void note_fault(const BusFault& fault);
  void restart_after_bus_off(std::vector<BusEvent>& events);

  SocketCanSettings settings_;
  std::vector<FrameFilter> filters_;
  std::unique_ptr<Buffers> buffers_;
  FileDescriptor socket_;
  std::optional<LinkMonitor> monitor_;
  LinkState link_;
  int bound_index_ = 0;
  std::uint32_t dropped_ = 0; // as the socket counts them
  std::optional<Clock::time_point> bus_off_since_;
};

} // namespace dyncal::drivers::can
