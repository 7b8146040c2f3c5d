#include "services/web/limited_server.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include "services/web/limited_stream.hpp"

namespace dyncal::services::web {

LimitedServer::LimitedServer(Refusals& refusals) : refusals_(refusals) {
  new_task_queue = [] { return new httplib::ThreadPool(max_threads); };
  set_payload_max_length(max_body_bytes);
  set_tcp_nodelay(true);
  set_keep_alive_max_count(max_requests); // for what it tells the visitor
  set_keep_alive_timeout(idle_limit.count());
}

void LimitedServer::end() {
  ending_ = true;
  stop();
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
