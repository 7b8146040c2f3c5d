#include "tests/can/usbip_device.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace dyncal::tests {

namespace {

constexpr const char* attach_file = "/sys/devices/platform/vhci_hcd.0/attach";
constexpr int high_speed_ports = 8;
constexpr int usb_speed_high = 3;
constexpr std::uint32_t device_id = 1;

constexpr std::uint32_t command_submit = 1;
constexpr std::uint32_t command_unlink = 2;
constexpr std::uint32_t answer_submit = 3;
constexpr std::uint32_t answer_unlink = 4;
constexpr std::uint32_t direction_in = 1;
constexpr std::uint32_t no_packets = 0xFFFFFFFF;

bool write_all(int socket, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

bool read_all(int socket, std::span<std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t got = ::recv(socket, bytes.data(), bytes.size(), 0);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

// Gives the kernel its end of the pair at the first free port.
bool attach(int socket) {
  for (int port = 0; port < high_speed_ports; ++port) {
    const drivers::FileDescriptor file(::open(attach_file, O_WRONLY | O_CLOEXEC));
    if (!file.is_open()) {
      return false;
    }
    const std::string line = std::to_string(port) + " " + std::to_string(socket) + " " +
                             std::to_string(device_id) + " " + std::to_string(usb_speed_high);
    if (::write(file.number(), line.data(), line.size()) == static_cast<ssize_t>(line.size())) {
      return true;
    }
  }
  return false;
}

} // namespace

// As it is on the wire: 48 bytes, numbers big-endian but for the eight bytes of a control request.
struct UsbipDevice::Header {
  std::uint32_t command;
  std::uint32_t sequence;
  std::uint32_t device;
  std::uint32_t direction;
  std::uint32_t endpoint;
  std::uint32_t flags_or_status; // of an unlink request: the sequence number that it is about
  std::uint32_t length;
  std::uint32_t start_frame;
  std::uint32_t packets;
  std::uint32_t interval_or_errors;
  std::array<std::uint8_t, 8> setup;
};

UsbipDevice::UsbipDevice(UsbFirmware& firmware) : firmware_(firmware) {
  static_assert(sizeof(Header) == 48);
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error("no socket pair");
  }
  socket_ = drivers::FileDescriptor(ends[0]);
  const drivers::FileDescriptor of_the_kernel(ends[1]);
  if (!attach(of_the_kernel.number())) {
    throw std::runtime_error("this kernel has no vhci_hcd with a free port");
  }
}

bool UsbipDevice::serve() {
  std::array<std::uint8_t, sizeof(Header)> bytes{};
  if (!read_all(socket_.number(), bytes)) {
    return false;
  }
  const auto header = std::bit_cast<Header>(bytes);
  if (ntohl(header.command) == command_unlink) {
    unlink(header);
  } else if (ntohl(header.command) == command_submit) {
    submit(header);
  } else {
    return false;
  }
  return true;
}

void UsbipDevice::submit(const Header& header) {
  const std::uint32_t length = ntohl(header.length);
  const bool in = ntohl(header.direction) == direction_in;
  std::vector<std::uint8_t> sent(in ? 0 : length);
  if (!read_all(socket_.number(), sent)) {
    return; // the next serve() says so
  }
  if (ntohl(header.endpoint) != 0) {
    if (in) {
      reads_.push_back({header.sequence, length});
      answer_reads();
    } else {
      answer(header.sequence, 0, {}, length);
      firmware_.bulk_out(sent);
    }
    return;
  }
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>(header.setup[at] | header.setup[at + 1] << 8U);
  };
  const ControlRequest request{header.setup[0], header.setup[1], word(2), word(4), word(6)};
  const auto said = firmware_.control(request, sent);
  if (!said) {
    answer(header.sequence, -EPIPE, {}, 0);
  } else if (request.to_host()) {
    answer(header.sequence, 0,
           std::span(*said).first(std::min<std::size_t>(said->size(), request.length)),
           said->size());
  } else {
    answer(header.sequence, 0, {}, length);
  }
}

void UsbipDevice::unlink(const Header& header) {
  const auto erased = std::erase_if(
      reads_, [&](const PendingRead& read) { return read.sequence == header.flags_or_status; });
  Header said{};
  said.command = htonl(answer_unlink);
  said.sequence = header.sequence;
  said.flags_or_status = htonl(static_cast<std::uint32_t>(erased > 0 ? -ECONNRESET : 0));
  static_cast<void>(
      write_all(socket_.number(), std::bit_cast<std::array<std::uint8_t, sizeof said>>(said)));
}

void UsbipDevice::answer(std::uint32_t sequence, int status, std::span<const std::uint8_t> data,
                         std::size_t actual_length) {
  Header said{};
  said.command = htonl(answer_submit);
  said.sequence = sequence;
  said.flags_or_status = htonl(static_cast<std::uint32_t>(status));
  said.length = htonl(static_cast<std::uint32_t>(data.empty() ? actual_length : data.size()));
  said.packets = no_packets;
  const auto head = std::bit_cast<std::array<std::uint8_t, sizeof said>>(said);
  std::vector<std::uint8_t> message(head.begin(), head.end());
  message.insert(message.end(), data.begin(), data.end());
  static_cast<void>(
      write_all(socket_.number(), message)); // a host that has gone is seen by the next serve()
}

void UsbipDevice::bulk_in(std::vector<std::uint8_t> transfer) {
  transfers_.push_back(std::move(transfer));
  answer_reads();
}

void UsbipDevice::answer_reads() {
  for (; !reads_.empty() && !transfers_.empty(); reads_.pop_front(), transfers_.pop_front()) {
    const std::span<const std::uint8_t> whole(transfers_.front());
    answer(reads_.front().sequence, 0,
           whole.first(std::min<std::size_t>(whole.size(), reads_.front().length)), 0);
  }
}

} // namespace dyncal::tests
