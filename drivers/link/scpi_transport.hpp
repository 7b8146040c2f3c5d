// What carries SCPI to an instrument: a TCP socket, or VXI-11 (RPC) through liblxi. Both deliver
// the answers as one stream of bytes.
//
// Addresses: "HOST:PORT" (raw socket; Rigol: port 5555) or "vxi11:HOST" (device inst0),
// "vxi11:HOST/inst1". Every wait has a limit. StopSignal ends waits on a TCP socket at once; liblxi
// cannot be interrupted, so over VXI-11 a stop takes effect when the limit of the wait that runs
// has passed, and the first connection to a host that is gone takes the RPC library's 25 s. A
// transport belongs to one thread at a time. Fails: malformed (address, line too long), not_found,
// refused, timeout, disconnected.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "drivers/error.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers {

class ScpiTransport {
public:
  virtual ~ScpiTransport() = default;
  [[nodiscard]] virtual Expected<void> send(std::string_view message,
                                            std::chrono::milliseconds limit) = 0;
  // Without its line end ("\n" or "\r\n").
  [[nodiscard]] virtual Expected<std::string> read_line(std::size_t longest,
                                                        std::chrono::milliseconds limit) = 0;
  [[nodiscard]] virtual Expected<void> read_exactly(std::span<char> bytes,
                                                    std::chrono::milliseconds limit) = 0;
  // Whether bytes have come that nobody has read: before a query that means an answer to something
  // else.
  [[nodiscard]] virtual bool has_unread() = 0;
};

// `stop` must outlive the transport.
[[nodiscard]] Expected<std::unique_ptr<ScpiTransport>>
connect_scpi_transport(const std::string& address, std::chrono::milliseconds limit,
                       const StopSignal& stop);

// VXI-11 alone; what connect_scpi_transport does for "vxi11:..." addresses.
[[nodiscard]] Expected<std::unique_ptr<ScpiTransport>>
connect_vxi11_transport(const std::string& address, std::chrono::milliseconds limit);

} // namespace dyncal::drivers
