// The clients of the generator's SCPI port.
//
// A client that waits for a bench time (:BENCh:WAIT?) is answered when the time has come, or after
// half a second of the host's time with the bench time by then; its further lines wait meanwhile. A
// line without an end after 4096 bytes, beside a packet of a waveform, closes its connection. One
// thread.
#pragma once

#include <chrono>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "drivers/link/file_descriptor.hpp"
#include "drivers/virtual_bench/wire/scpi_instrument.hpp"

namespace dyncal::drivers::virtual_bench {

class LineClients {
public:
  explicit LineClients(ScpiInstrument& instrument) : instrument_(instrument) {}

  void add(FileDescriptor socket);
  void close_all() { clients_.clear(); }
  // Reads and executes what has come, and answers the waits that are over at this bench time.
  void serve(double bench_time_s);

  [[nodiscard]] std::optional<double> earliest_wait_s() const;
  [[nodiscard]] std::vector<int> descriptors() const;

private:
  struct Client {
    FileDescriptor socket;
    std::string received;
    std::string answers;
    std::optional<double> wait_until_s;
    std::chrono::steady_clock::time_point wait_ends;
  };
  // False when the client has gone.
  bool serve(Client& client, double bench_time_s);
  void execute_lines(Client& client, double bench_time_s);

  ScpiInstrument& instrument_;
  std::list<Client> clients_;
};

} // namespace dyncal::drivers::virtual_bench
