#include "services/programs/web/limited_stream.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace dyncal::inline programs::web {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds look_again = 50ms;

// Of one end of the connection; as it was where that is gone.
void address_of(socket_t socket, int (*ask)(int, sockaddr*, socklen_t*), std::string& ip,
                int& port) {
  sockaddr_storage storage{};
  socklen_t length = sizeof(storage);
  if (ask(socket, reinterpret_cast<sockaddr*>(&storage), &length) != 0) {
    return;
  }
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (storage.ss_family == AF_INET) {
    const auto& address = reinterpret_cast<const sockaddr_in&>(storage);
    inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    port = ntohs(address.sin_port);
  } else if (storage.ss_family == AF_INET6) {
    const auto& address = reinterpret_cast<const sockaddr_in6&>(storage);
    inet_ntop(AF_INET6, &address.sin6_addr, text.data(), text.size());
    port = ntohs(address.sin6_port);
  }
  ip = text.data();
}

} // namespace

LimitedStream::LimitedStream(VisitorSocket& socket, std::string request,
                             const std::atomic<bool>& stopping,
                             const std::atomic<std::size_t>& waiting)
    : socket_(socket), request_(std::move(request)), stopping_(stopping), waiting_(waiting) {}

bool LimitedStream::is_writable() const {
  const auto began = Clock::now();
  while (!stopping_) {
    pollfd one{.fd = socket_.number(), .events = POLLOUT, .revents = 0};
    if (poll(&one, 1, static_cast<int>(look_again.count())) > 0) {
      return (one.revents & (POLLERR | POLLHUP)) == 0;
    }
    const auto passed = Clock::now() - began;
    if (passed >= write_limit || (waiting_ > 0 && passed >= crowded_write_limit)) {
      was_slow_ = true;
      return false;
    }
  }
  return false;
}

ssize_t LimitedStream::read(char* data, size_t size) {
  if (taken_ == request_.size()) {
    return -1;
  }
  const std::size_t count = std::min(size, request_.size() - taken_);
  std::memcpy(data, request_.data() + taken_, count);
  taken_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t LimitedStream::write(const char* data, size_t size) {
  ssize_t count = VisitorSocket::nothing_yet;
  while (count == VisitorSocket::nothing_yet && is_writable()) {
    count = socket_.send(data, size);
  }
  return count > 0 ? count : -1;
}

void LimitedStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  address_of(socket_.number(), getpeername, ip, port);
}

void LimitedStream::get_local_ip_and_port(std::string& ip, int& port) const {
  address_of(socket_.number(), getsockname, ip, port);
}

std::string visitor_of(socket_t socket) {
  std::string ip;
  int port = 0;
  address_of(socket, getpeername, ip, port);
  return ip;
}

} // namespace dyncal::inline programs::web
