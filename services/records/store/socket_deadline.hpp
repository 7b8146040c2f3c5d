// A limit for anyone who waits at a socket in a library that has none of its own: when it has
// passed, the socket is shut down, and the library finds that its peer has gone.
//
// Make one before the call that may wait, and let it go out of scope after it, while the socket is
// still open. Throws std::system_error where no thread can be made. One thread uses it.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

namespace dyncal::inline records {

class SocketDeadline {
public:
  SocketDeadline(int socket, std::chrono::milliseconds limit);

  [[nodiscard]] bool has_passed() const { return passed_; }

private:
  std::atomic<bool> passed_{false};
  std::jthread watch_; // the last member: it uses the others
};

} // namespace dyncal::inline records
