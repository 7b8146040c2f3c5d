// A TCP connection to an instrument, seen from our side: every wait has a limit and can be ended
// from another thread.
//
// A connection belongs to one thread at a time. StopSignal may be raised from any thread; it ends
// the wait that runs and every later one at once, with ErrorCode::disconnected. Fails: malformed
// (an address that is not HOST:PORT), not_found (no such host), refused (nobody listens), timeout,
// disconnected.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "drivers/error.hpp"

namespace dyncal::drivers {

struct Address {
  std::string host;
  std::uint16_t port = 0;

  [[nodiscard]] std::string text() const { return host + ":" + std::to_string(port); }
};

// "127.0.0.1:5026", "localhost:5026", "[::1]:5026".
[[nodiscard]] Expected<Address> parse_address(std::string_view text);

// Owns one file descriptor.
class Descriptor {
public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept;
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool open() const { return number_ >= 0; }

private:
  int number_;
};

class StopSignal {
public:
  StopSignal();
  void raise();
  [[nodiscard]] bool raised() const;
  // True when it was raised before `limit` had passed.
  [[nodiscard]] bool wait_for(std::chrono::nanoseconds limit) const;
  [[nodiscard]] int descriptor() const { return event_.number(); }

private:
  Descriptor event_;
};

class TcpConnection {
public:
  // `stop` must outlive the connection.
  [[nodiscard]] static Expected<TcpConnection>
  connect(const Address& address, std::chrono::milliseconds limit, const StopSignal& stop);

  [[nodiscard]] Expected<void> send_all(std::string_view bytes, std::chrono::milliseconds limit);
  // Without its line end ("\n" or "\r\n"). A longer line than `longest` is malformed.
  [[nodiscard]] Expected<std::string> read_line(std::size_t longest,
                                                std::chrono::milliseconds limit);
  [[nodiscard]] Expected<void> read_exactly(std::span<char> bytes, std::chrono::milliseconds limit);
  // Bytes have come that nobody has read. Does not wait.
  [[nodiscard]] bool has_unread() const;

private:
  TcpConnection(Descriptor socket, Address address, const StopSignal& stop)
      : socket_(std::move(socket)), address_(std::move(address)), stop_(&stop) {}
  Expected<void> wait(short events, std::chrono::steady_clock::time_point deadline);
  Expected<std::size_t> receive(std::span<char> bytes,
                                std::chrono::steady_clock::time_point deadline);

  Descriptor socket_;
  Address address_;
  const StopSignal* stop_;
  std::string received_; // bytes that came after the end of the last line
};

} // namespace dyncal::drivers
