// A connection as cpp-httplib reads and writes it, with time limits of whole requests: its own are
// of single reads, so that a visitor who sends a byte a second would hold a thread for ever.
//
// A read fails once the deadline of the request has passed, a write when the visitor takes nothing
// for `write_limit`, and both when the server stops. One thread.
#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include <httplib.h>

namespace dyncal::services::web {

class LimitedStream final : public httplib::Stream {
public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds write_limit{5};

  // `stopping` outlives the object, which does not close the socket.
  LimitedStream(socket_t socket, const std::atomic<bool>& stopping);

  // The next request has so long to come.
  void set_deadline(Clock::time_point deadline) { deadline_ = deadline; }
  // Something can be read until then; false: nothing came, or the other side has closed.
  [[nodiscard]] bool wait_readable(Clock::time_point until) const;
  [[nodiscard]] bool was_slow() const { return was_slow_; }

  [[nodiscard]] bool is_readable() const override { return wait_readable(deadline_); }
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* data, size_t size) override;
  ssize_t write(const char* data, size_t size) override;
  using httplib::Stream::write;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_; }

private:
  bool fill();

  socket_t socket_;
  const std::atomic<bool>& stopping_;
  Clock::time_point deadline_{};
  std::string buffer_; // read, and not asked for yet
  std::size_t taken_ = 0;
  bool was_slow_ = false;
};

} // namespace dyncal::services::web
