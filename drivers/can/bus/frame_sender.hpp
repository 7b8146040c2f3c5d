// Sends frames on a CAN interface: for virtual sensors and tests, never for a bus with a sensor
// under calibration.
//
// One raw socket that receives nothing. send() gives the frame to the kernel, which on a virtual
// interface stamps it at once.
//
// Fails: at open() when the kernel has no CAN sockets, or the interface does not exist or is not a
// CAN interface; at send() when the kernel refuses the frame (the interface is down; an FD frame on
// an interface with the MTU of classic CAN). One thread.
#pragma once

#include <string>

#include "drivers/can/bus/can_frame.hpp"
#include "drivers/error.hpp"
#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers::can {

class FrameSender {
public:
  [[nodiscard]] static Expected<FrameSender> open(const std::string& interface_name);

  [[nodiscard]] Expected<void> send(const CanFrame& frame);

private:
  FrameSender(std::string interface_name, FileDescriptor socket)
      : interface_name_(std::move(interface_name)), socket_(std::move(socket)) {}

  std::string interface_name_;
  FileDescriptor socket_;
};

} // namespace dyncal::drivers::can
