// A connection as cpp-httplib reads and writes it: it reads one request, which has come as a whole
// (limited_server.hpp), and writes to the visitor with a time limit, so that no thread waits for
// anybody who sends or takes a byte a second.
//
// A read fails after the end of the request. A write fails when the visitor takes nothing for
// `write_limit`, or for `crowded_write_limit` while others wait for a thread, and when the server
// stops. One thread.
#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include <httplib.h>

#include "services/programs/web/visitor_socket.hpp"

namespace dyncal::inline programs::web {

class LimitedStream final : public httplib::Stream {
public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds write_limit{5};
  // 400 who take nothing are through 64 threads in 1.4 s.
  static constexpr std::chrono::milliseconds crowded_write_limit{200};

  // `stopping`, `waiting` (how many wait for a thread) and the socket outlive the object, which
  // does not close it.
  LimitedStream(VisitorSocket& socket, std::string request, const std::atomic<bool>& stopping,
                const std::atomic<std::size_t>& waiting);

  [[nodiscard]] bool was_slow() const { return was_slow_; }

  [[nodiscard]] bool is_readable() const override { return taken_ < request_.size(); }
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* data, size_t size) override;
  ssize_t write(const char* data, size_t size) override;
  using httplib::Stream::write;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_.number(); }

private:
  VisitorSocket& socket_;
  std::string request_;
  std::size_t taken_ = 0;
  const std::atomic<bool>& stopping_;
  const std::atomic<std::size_t>& waiting_;
  mutable bool was_slow_ = false;
};

// "192.0.2.7"; empty: it is not connected any more.
[[nodiscard]] std::string visitor_of(socket_t socket);

} // namespace dyncal::inline programs::web
