#include "drivers/link/tcp_connection.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include <linux/sockios.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace dyncal::drivers {
namespace {

using Clock = std::chrono::steady_clock;

int milliseconds_until(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<long long>(left, 0, 3'600'000));
}

enum class Ready { yes, stopped, timed_out };

Ready wait_for_events(int descriptor, short events, int stop_descriptor,
                      Clock::time_point deadline) {
  for (;;) {
    pollfd watched[2] = {{descriptor, events, 0}, {stop_descriptor, POLLIN, 0}};
    const int count = poll(watched, 2, milliseconds_until(deadline));
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (watched[1].revents != 0) {
      return Ready::stopped;
    }
    if (count > 0) {
      return Ready::yes;
    }
    if (Clock::now() >= deadline) {
      return Ready::timed_out;
    }
  }
}

Expected<std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>> resolve(const Address& address) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int status =
      getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
  if (status != 0) {
    return fail(ErrorCode::not_found,
                address.text() + ": no host of this name (" + gai_strerror(status) + ")");
  }
  return std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>(found, &freeaddrinfo);
}

// Commands leave at once; an instrument that is switched off without a farewell is noticed within
// about ten seconds.
void set_options(int socket) {
  const auto set = [socket](int level, int option, int value) {
    setsockopt(socket, level, option, &value, sizeof(value));
  };
  set(IPPROTO_TCP, TCP_NODELAY, 1);
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 4);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 2);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
}

// The outcome of one non-blocking connect: 0, or an errno value.
int connect_once(int socket, const addrinfo& target, int stop_descriptor,
                 Clock::time_point deadline) {
  if (::connect(socket, target.ai_addr, target.ai_addrlen) == 0) {
    return 0;
  }
  if (errno != EINPROGRESS) {
    return errno;
  }
  switch (wait_for_events(socket, POLLOUT, stop_descriptor, deadline)) {
  case Ready::stopped:
    return ECANCELED;
  case Ready::timed_out:
    return ETIMEDOUT;
  case Ready::yes:
    break;
  }
  int status = 0;
  socklen_t size = sizeof(status);
  getsockopt(socket, SOL_SOCKET, SO_ERROR, &status, &size);
  return status;
}

// What is not acknowledged by the kernel of the other side is still on its way, or was lost.
bool is_under_way(int socket) {
  int bytes = 0;
  return ioctl(socket, SIOCOUTQ, &bytes) == 0 && bytes > 0;
}

} // namespace

Expected<TcpConnection> TcpConnection::connect(const Address& address,
                                               std::chrono::milliseconds limit,
                                               const StopSignal& stop) {
  const auto deadline = Clock::now() + limit;
  DYNCAL_TRY(auto targets, resolve(address));
  int status = ECONNREFUSED;
  for (const addrinfo* target = targets.get(); target != nullptr; target = target->ai_next) {
    FileDescriptor socket(
        ::socket(target->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!socket.is_open()) {
      status = errno;
      continue;
    }
    status = connect_once(socket.number(), *target, stop.descriptor(), deadline);
    if (status == 0) {
      set_options(socket.number());
      return TcpConnection(std::move(socket), address, stop);
    }
  }
  if (status == ECANCELED) {
    return fail(ErrorCode::disconnected, address.text() + ": stopped while connecting");
  }
  if (status == ETIMEDOUT) {
    return fail(ErrorCode::timeout,
                address.text() + ": no answer; is the instrument switched on and in this network?");
  }
  return fail(ErrorCode::refused,
              address.text() + ": " + std::strerror(status) + "; is the instrument switched on?");
}

Expected<void> TcpConnection::wait(short events, Clock::time_point deadline) {
  switch (wait_for_events(socket_.number(), events, stop_->descriptor(), deadline)) {
  case Ready::stopped:
    return fail(ErrorCode::disconnected, address_.text() + ": stopped");
  case Ready::timed_out:
    return fail(ErrorCode::timeout,
                address_.text() +
                    (is_under_way(socket_.number())
                         ? ": what was sent to the instrument does not arrive; is the "
                           "network to it interrupted or overloaded?"
                         : ": the instrument does not answer"));
  case Ready::yes:
    break;
  }
  return {};
}

Expected<void> TcpConnection::send_all(std::string_view bytes, std::chrono::milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (!bytes.empty()) {
    const ssize_t sent = send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      DYNCAL_TRY(wait(POLLOUT, deadline));
    } else if (errno != EINTR) {
      return fail(ErrorCode::disconnected,
                  address_.text() + ": the connection is lost (" + std::strerror(errno) + ")");
    }
  }
  return {};
}

Expected<std::size_t> TcpConnection::receive(std::span<char> bytes, Clock::time_point deadline) {
  for (;;) {
    const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), 0);
    if (count > 0) {
      return static_cast<std::size_t>(count);
    }
    if (count == 0) {
      return fail(ErrorCode::disconnected,
                  address_.text() + ": the instrument has closed the connection");
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) {
      DYNCAL_TRY(wait(POLLIN, deadline));
    } else if (errno != EINTR) {
      return fail(ErrorCode::disconnected,
                  address_.text() + ": the connection is lost (" + std::strerror(errno) + ")");
    }
  }
}

Expected<std::string> TcpConnection::read_line(std::size_t max_bytes,
                                               std::chrono::milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  std::size_t searched = 0;
  for (;;) {
    const std::size_t end = received_.find('\n', searched);
    if (end != std::string::npos && end <= max_bytes) {
      std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      if (!line.empty() && line.back() == '\r') {
        line.pop_back();
      }
      return line;
    }
    if (received_.size() > max_bytes) {
      return fail(ErrorCode::malformed, address_.text() + ": a line without an end after " +
                                            std::to_string(max_bytes) + " bytes");
    }
    searched = received_.size();
    char chunk[4096];
    DYNCAL_TRY(auto count, receive(chunk, deadline));
    received_.append(chunk, count);
  }
}

bool TcpConnection::has_unread() const {
  char byte = 0;
  return !received_.empty() || recv(socket_.number(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) > 0;
}

void TcpConnection::set_delivery_limit(std::chrono::milliseconds limit) {
  const auto limit_ms = static_cast<unsigned int>(limit.count());
  setsockopt(socket_.number(), IPPROTO_TCP, TCP_USER_TIMEOUT, &limit_ms, sizeof(limit_ms));
}

void TcpConnection::abandon() {
  const linger at_once{.l_onoff = 1, .l_linger = 0};
  setsockopt(socket_.number(), SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
  socket_.reset();
  received_.clear();
}

Expected<void> TcpConnection::read_exactly(std::span<char> bytes, std::chrono::milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  const std::size_t waiting = std::min(bytes.size(), received_.size());
  std::copy_n(received_.begin(), waiting, bytes.begin());
  received_.erase(0, waiting);
  bytes = bytes.subspan(waiting);
  while (!bytes.empty()) {
    DYNCAL_TRY(auto count, receive(bytes, deadline));
    bytes = bytes.subspan(count);
  }
  return {};
}

} // namespace dyncal::drivers
