// What carries SCPI to an instrument: a TCP socket, or VXI-11 (RPC) through liblxi. Both deliver
// the answers as one stream of bytes.
//
//   HOST:PORT                       raw socket (Rigol: port 5555, Keysight: port 5025)
//   vxi11:HOST, vxi11:HOST/inst1    VXI-11, device inst0 unless another is named
//
// Every wait has a limit. StopSignal ends waits on a TCP socket at once. liblxi cannot be
// interrupted: over VXI-11 a stop takes effect when the limit of the wait that runs has passed, and
// the first connection to a host that has gone takes the 25 s of the RPC library.
//
// Fails: malformed (address, line too long), not_found, refused, timeout, disconnected. A transport
// belongs to one thread at a time.
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
  [[nodiscard]] virtual Expected<std::string> read_line(std::size_t max_bytes,
                                                        std::chrono::milliseconds limit) = 0;
  [[nodiscard]] virtual Expected<void> read_exactly(std::span<char> bytes,
                                                    std::chrono::milliseconds limit) = 0;
  // Whether a line that was not there within its limit may be read on: else it is lost.
  [[nodiscard]] virtual bool keeps_part_of_line() const { return false; }
  // Whether bytes have come that were not read: before a query they answer something else.
  [[nodiscard]] virtual bool has_unread() = 0;
  // Nothing arrives at the instrument later than this after it was sent. liblxi has no such limit:
  // over VXI-11 the kernel's own holds.
  virtual void set_delivery_limit(std::chrono::milliseconds /*limit*/) {}
  // Closes at once; what has not been delivered yet is forgotten. Nothing else is called after it.
  virtual void abandon() {}
};

// `stop` must outlive the transport.
[[nodiscard]] Expected<std::unique_ptr<ScpiTransport>>
connect_scpi_transport(const std::string& address, std::chrono::milliseconds limit,
                       const StopSignal& stop);

// VXI-11 alone; what connect_scpi_transport does for "vxi11:..." addresses.
[[nodiscard]] Expected<std::unique_ptr<ScpiTransport>>
connect_vxi11_transport(const std::string& address, std::chrono::milliseconds limit);

} // namespace dyncal::drivers
