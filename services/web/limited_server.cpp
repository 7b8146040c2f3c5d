#include "services/web/limited_server.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "services/web/limited_stream.hpp"

namespace dyncal::services::web {

LimitedServer::LimitedServer(Refusals& refusals) : refusals_(refusals) {
  new_task_queue = [] { return new httplib::ThreadPool(max_threads); };
  set_payload_max_length(max_body_bytes);
  set_tcp_nodelay(true);
  set_socket_options([](socket_t socket) {
    // So that a daemon that starts again need not wait for connections of the one before.
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  set_keep_alive_max_count(max_requests); // for what it tells the visitor
  set_keep_alive_timeout(idle_limit.count());
}

int LimitedServer::bind(const std::string& host, int port) {
  errno = 0;
  if (port == 0) {
    port = bind_to_any_port(host);
  } else if (!bind_to_port(host, port)) {
    return -1;
  }
  // The library has called it with a queue of five.
  if (port <= 0 || ::listen(svr_sock_, max_waiting) != 0) {
    return -1;
  }
  listening_ = dup(svr_sock_);
  return listening_ < 0 ? -1 : port;
}

void LimitedServer::end() {
  ending_ = true;
  // The library's stop() does nothing to a server whose thread is about to listen, but has not yet.
  shutdown(listening_, SHUT_RDWR);
}

LimitedServer::~LimitedServer() {
  if (listening_ >= 0) {
    close(listening_);
  }
}

bool LimitedServer::process_and_close_socket(socket_t socket) {
  serve(socket);
  shutdown(socket, SHUT_RDWR);
  close(socket);
  return true;
}

void LimitedServer::serve(socket_t socket) {
  LimitedStream stream(socket, ending_);
  for (int count = 1; count <= max_requests && !ending_; ++count) {
    if (!stream.wait_readable(LimitedStream::Clock::now() + idle_limit)) {
      return;
    }
    stream.set_deadline(LimitedStream::Clock::now() + request_limit);
    bool is_closed = false;
    const bool was_served =
        process_request(stream, count == max_requests, is_closed, [](httplib::Request&) {});
    ++requests_;
    if (stream.was_slow()) {
      refusals_.count(Refusal::slow);
      return;
    }
    if (!was_served || is_closed) {
      return;
    }
  }
}

} // namespace dyncal::services::web
