// The HTTP server of cpp-httplib with limits for visitors that nobody invited: a whole request has
// `request_limit` to come, an idle connection `idle_limit`, a connection `max_requests`; what is
// refused is counted.
//
// `max_threads` connections are served at a time, each by a thread; others wait in the kernel's
// queue and the pool's. The library's own kernel queue holds five: whoever came sixth in the same
// instant waited for seconds until his computer asked again. It also shares its port with any other
// server that wants it, so that visitors would reach one or the other by chance; this one does not.
// Threads: as httplib::Server.
#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include <httplib.h>

#include "services/web/refusals.hpp"

namespace dyncal::services::web {

class LimitedServer final : public httplib::Server {
public:
  static constexpr std::chrono::seconds request_limit{5};
  static constexpr std::chrono::seconds idle_limit{1};
  static constexpr int max_requests = 100;
  static constexpr std::size_t max_threads = 64;
  static constexpr int max_waiting = 256; // connections in the kernel's queue
  static constexpr std::size_t max_body_bytes = std::size_t{64} * 1024;

  // `refusals` outlives the object.
  explicit LimitedServer(Refusals& refusals);
  ~LimitedServer() override;
  LimitedServer(const LimitedServer&) = delete;
  LimitedServer& operator=(const LimitedServer&) = delete;

  // Binds to this port, 0: to any free one, and returns it; negative: it cannot be had (errno).
  [[nodiscard]] int bind(const std::string& host, int port);
  // Ends every connection and the listening, or keeps it from beginning.
  void end();
  [[nodiscard]] bool is_ending() const { return ending_; }
  [[nodiscard]] std::uint64_t requests() const { return requests_; }

private:
  bool process_and_close_socket(socket_t socket) override;
  void serve(socket_t socket);

  Refusals& refusals_;
  int listening_ = -1; // a second descriptor of the listening socket, which nobody else closes
  std::atomic<bool> ending_ = false;
  std::atomic<std::uint64_t> requests_ = 0;
};

} // namespace dyncal::services::web
