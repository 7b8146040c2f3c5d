// The oscilloscope (SCPI) and the time series sensor of the virtual bench on their TCP ports.
//
// The oscilloscope serves up to four clients, whose commands act on one instrument; answers leave
// in pieces of the given size, with faults as OscilloscopeScpi makes them. The sensor sends every
// series, when it is complete, to all clients that are connected. Sockets never block. One thread.
#pragma once

#include <chrono>
#include <list>
#include <vector>

#include "drivers/link/address.hpp"
#include "drivers/link/file_descriptor.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/virtual_bench/model/series_sensor.hpp"
#include "drivers/virtual_bench/wire/oscilloscope_scpi.hpp"

namespace dyncal::drivers::virtual_bench {

struct TriggeredSettings {
  Address scope_listen; // port 0: the system chooses
  Address sensor_listen;
  TriggerSettings trigger;
  SeriesSensorSettings sensor;
  ScopeFaults faults;
  std::size_t piece_bytes =
      0; // an answer longer than this leaves in such pieces, one per call of serve(); 0: whole
};

class TriggeredServer {
public:
  explicit TriggeredServer(const TriggeredSettings& settings);

  // Fails (refused) when a port cannot be listened on.
  [[nodiscard]] Expected<void> open();
  [[nodiscard]] std::uint16_t scope_port() const;
  [[nodiscard]] std::uint16_t sensor_port() const;

  void serve();
  void advance_to(double time_s, const Excitation& excitation);
  [[nodiscard]] std::vector<int> descriptors() const;
  // Bytes wait to leave that could not so far.
  [[nodiscard]] bool has_backlog() const;

  [[nodiscard]] const OscilloscopeModel& scope() const { return scope_; }
  [[nodiscard]] const SeriesSensor& sensor() const { return sensor_; }

private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    FileDescriptor socket;
    std::string received;
    std::string sending;
    bool disconnect = false; // once `sending` has left
    Clock::time_point not_before{};
  };
  // False when the client has gone.
  bool serve_scope(Client& client);
  static bool receive(Client& client);
  bool transmit(Client& client, std::size_t most) const;

  TriggeredSettings settings_;
  OscilloscopeModel scope_;
  OscilloscopeScpi scpi_;
  SeriesSensor sensor_;
  FileDescriptor scope_listener_;
  FileDescriptor sensor_listener_;
  std::list<Client> scope_clients_;
  std::list<Client> sensor_clients_;
};

} // namespace dyncal::drivers::virtual_bench
