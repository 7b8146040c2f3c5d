// A TCP connection to an instrument, which listens: every wait has a limit and can be ended from
// another thread.
//
// Fails: not_found (no such host), refused (nobody listens there), timeout, malformed (a line
// longer than its limit), disconnected (the instrument closed, the network lost it, or a stop was
// requested).
//
// A connection belongs to one thread at a time. The StopSignal may be raised from any thread; it
// ends the wait that runs and every later one at once, with ErrorCode::disconnected.
#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "drivers/error.hpp"
#include "drivers/link/address.hpp"
#include "drivers/link/file_descriptor.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers {

class TcpConnection {
public:
  // `stop` must outlive the connection.
  [[nodiscard]] static Expected<TcpConnection>
  connect(const Address& address, std::chrono::milliseconds limit, const StopSignal& stop);

  [[nodiscard]] Expected<void> send_all(std::string_view bytes, std::chrono::milliseconds limit);
  // Without its line end ("\n" or "\r\n"). A line of more than `max_bytes` is malformed.
  [[nodiscard]] Expected<std::string> read_line(std::size_t max_bytes,
                                                std::chrono::milliseconds limit);
  [[nodiscard]] Expected<void> read_exactly(std::span<char> bytes, std::chrono::milliseconds limit);
  // Whether bytes have come that were not read. Does not wait.
  [[nodiscard]] bool has_unread() const;

  // Bytes whose arrival is not confirmed within the limit end the connection (TCP_USER_TIMEOUT): a
  // command never arrives later than that, whatever the network does, also when this program has
  // died meanwhile.
  void set_delivery_limit(std::chrono::milliseconds limit);
  // Closes at once. What has not been delivered yet is forgotten (SO_LINGER of 0), where a plain
  // close lets the kernel go on delivering it for minutes.
  void abandon();

private:
  TcpConnection(FileDescriptor socket, Address address, const StopSignal& stop)
      : socket_(std::move(socket)), address_(std::move(address)), stop_(&stop) {}
  Expected<void> wait(short events, std::chrono::steady_clock::time_point deadline);
  Expected<std::size_t> receive(std::span<char> bytes,
                                std::chrono::steady_clock::time_point deadline);

  FileDescriptor socket_;
  Address address_;
  const StopSignal* stop_;
  std::string received_; // what came after the last line or block that was read
};

} // namespace dyncal::drivers
