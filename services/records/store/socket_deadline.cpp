#include "services/records/store/socket_deadline.hpp"

#include <condition_variable>
#include <mutex>

#include <sys/socket.h>

namespace dyncal::inline records {

SocketDeadline::SocketDeadline(int socket, std::chrono::milliseconds limit)
    : watch_([this, socket, limit](const std::stop_token& stop) {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any ended;
        ended.wait_for(lock, stop, limit, [] { return false; });
        if (!stop.stop_requested()) {
          passed_ = true;
          ::shutdown(socket, SHUT_RDWR);
        }
      }) {}

} // namespace dyncal::inline records
