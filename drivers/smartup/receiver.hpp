// Receives the datagrams of SmartUp Units at one or more UDP addresses on one thread, which does
// nothing that could wait: batches by recvmmsg, a receive buffer as large as the system allows, the
// kernel's count of what did not fit.
//
// At high rates the thread rests five milliseconds after it has emptied the sockets, so that
// datagrams come in batches: the buffer holds far more than that, and a core is spared the
// wake-ups.
//
// Threads: create, start and stop from one thread; sinks and observers are called on the receiver's
// thread. The destructor stops.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/smartup/reception.hpp"

namespace dyncal::drivers::smartup {

// "0.0.0.0:7654" or ":7654"; port 0: any free one.
struct ListenAddress {
  std::uint32_t address = 0; // host's byte order
  std::uint16_t port = 0;
};

// Fails (invalid_setting) on anything else.
[[nodiscard]] Expected<ListenAddress> parse_listen_address(const std::string& text);

class Receiver {
public:
  struct Endpoint {
    std::string listen;                    // address and port
    std::vector<WantedSensor> wanted;      // no sensor twice
    ReceptionObserver* observer = nullptr; // outlives the receiver
    int receive_buffer_bytes = 32 << 20;   // asked for; the system may give less
  };

  // Opens the sockets. Fails (invalid_setting) on a bad address, (refused) when it is in use, not
  // of this host, or not permitted.
  [[nodiscard]] static Expected<std::unique_ptr<Receiver>> create(std::vector<Endpoint> endpoints);
  ~Receiver();

  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  // Of the endpoint, as the system gave it.
  [[nodiscard]] std::uint16_t port(std::size_t endpoint) const;
  [[nodiscard]] int receive_buffer_bytes(std::size_t endpoint) const;

  void start();
  // Hands over what is held, and ends the thread. Idempotent.
  void stop();

private:
  class Socket;
  class Batch;
  Receiver();
  void run();

  std::vector<std::unique_ptr<Socket>> sockets_;
  StopSignal stop_;
  std::thread thread_;
};

} // namespace dyncal::drivers::smartup
