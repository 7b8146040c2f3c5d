// A USB device that a program plays: plugged into the kernel's virtual host controller (vhci_hcd)
// over a socket pair that speaks USB/IP (Documentation/usb/usbip_protocol.rst), so that the
// kernel's own driver binds to it as to a real one.
//
// The host's control requests and what it writes to bulk endpoint 2 go to the firmware; what the
// firmware queues answers the host's reads of bulk endpoint 1 in their order. Plugged in by the
// constructor, which throws std::runtime_error where the kernel has no free port; pulled out by the
// destructor. Everything in one thread but the constructor. High speed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::tests {

struct ControlRequest {
  std::uint8_t type = 0; // bmRequestType
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;

  [[nodiscard]] bool to_host() const { return (type & 0x80U) != 0; }
  [[nodiscard]] bool standard() const { return (type & 0x60U) == 0; }
};

class UsbFirmware {
public:
  virtual ~UsbFirmware() = default;
  // What the device says to it; nothing: it does not know the request (stall).
  virtual std::optional<std::vector<std::uint8_t>> control(const ControlRequest& request,
                                                           std::span<const std::uint8_t> sent) = 0;
  virtual void bulk_out(std::span<const std::uint8_t> sent) = 0;
};

class UsbipDevice {
public:
  explicit UsbipDevice(UsbFirmware& firmware);

  // Readable when serve() has something to do.
  [[nodiscard]] int descriptor() const { return socket_.number(); }
  // One message of the host. False: the host has let go of the device.
  bool serve();
  void bulk_in(std::vector<std::uint8_t> transfer);

private:
  struct Header;
  struct PendingRead {
    std::uint32_t sequence; // as it came
    std::uint32_t length;
  };

  void submit(const Header& header);
  void unlink(const Header& header);
  void answer(std::uint32_t sequence, int status, std::span<const std::uint8_t> data,
              std::size_t actual_length);
  void answer_reads();

  UsbFirmware& firmware_;
  drivers::FileDescriptor socket_;
  std::deque<PendingRead> reads_;
  std::deque<std::vector<std::uint8_t>> transfers_; // as many as the host leaves unread
};

} // namespace dyncal::tests
