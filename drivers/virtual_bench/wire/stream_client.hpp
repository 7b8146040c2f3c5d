// The one client of the ACS stream: frames wait here until the client takes them.
//
// drivers/acs/README.md defines the stream. The socket's own buffer is kept small, so that
// backlog_bytes() soon shows when the client does not keep up; anyone who produces frames stops
// then. One thread.
#pragma once

#include <string>

#include "drivers/link/file_descriptor.hpp"
#include "drivers/virtual_bench/model/acs_instrument.hpp"

namespace dyncal::drivers::virtual_bench {

class StreamClient {
public:
  [[nodiscard]] bool connected() const { return socket_.is_open(); }
  [[nodiscard]] int descriptor() const { return socket_.number(); }
  [[nodiscard]] std::size_t backlog_bytes() const { return backlog_.size() - sent_; }

  // Takes the place of a client that has gone; `description` is its first line.
  void connect(FileDescriptor socket, const std::string& description);
  void send_frame(const AcsSamples& samples);
  void send_end();
  // Sends what the socket takes and notices a client that has gone.
  void serve();

private:
  void drop();

  FileDescriptor socket_;
  std::string backlog_;
  std::size_t sent_ = 0; // bytes of the backlog that are on their way
};

} // namespace dyncal::drivers::virtual_bench
