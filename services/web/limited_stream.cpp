#include "services/web/limited_stream.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace dyncal::services::web {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t buffer_bytes = 4096;

void address_of(const sockaddr_storage& storage, std::string& ip, int& port) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (storage.ss_family == AF_INET) {
    sockaddr_in address{};
    std::memcpy(&address, &storage, sizeof(address));
    inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    port = ntohs(address.sin_port);
  } else if (storage.ss_family == AF_INET6) {
    sockaddr_in6 address{};
    std::memcpy(&address, &storage, sizeof(address));
    inet_ntop(AF_INET6, &address.sin6_addr, text.data(), text.size());
    port = ntohs(address.sin6_port);
  }
  ip = text.data();
}

} // namespace

LimitedStream::LimitedStream(socket_t socket, const std::atomic<bool>& stopping)
    : socket_(socket), stopping_(stopping) {}

bool LimitedStream::wait_readable(Clock::time_point until) const {
  if (taken_ < buffer_.size()) {
    return true;
  }
  while (!stopping_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    if (left <= 0ms) {
      return false;
    }
    pollfd one{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&one, 1, static_cast<int>(std::min(left, 200ms).count())) > 0) {
      return (one.revents & (POLLIN | POLLHUP)) != 0;
    }
  }
  return false;
}

bool LimitedStream::is_writable() const {
  const auto until = Clock::now() + write_limit;
  while (!stopping_ && Clock::now() < until) {
    pollfd one{.fd = socket_, .events = POLLOUT, .revents = 0};
    if (poll(&one, 1, 200) > 0) {
      return (one.revents & (POLLERR | POLLHUP)) == 0;
    }
  }
  return false;
}

bool LimitedStream::fill() {
  if (!wait_readable(deadline_)) {
    was_slow_ = was_slow_ || Clock::now() >= deadline_;
    return false;
  }
  buffer_.resize(buffer_bytes);
  const ssize_t count = recv(socket_, buffer_.data(), buffer_.size(), 0);
  buffer_.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  taken_ = 0;
  return count > 0;
}

ssize_t LimitedStream::read(char* data, size_t size) {
  if (taken_ == buffer_.size() && !fill()) {
    return -1;
  }
  const std::size_t count = std::min(size, buffer_.size() - taken_);
  std::memcpy(data, buffer_.data() + taken_, count);
  taken_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t LimitedStream::write(const char* data, size_t size) {
  if (!is_writable()) {
    return -1;
  }
  return send(socket_, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
}

void LimitedStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage storage{};
  socklen_t length = sizeof(storage);
  if (getpeername(socket_, reinterpret_cast<sockaddr*>(&storage), &length) == 0) {
    address_of(storage, ip, port);
  }
}

void LimitedStream::get_local_ip_and_port(std::string& ip, int& port) const {
  sockaddr_storage storage{};
  socklen_t length = sizeof(storage);
  if (getsockname(socket_, reinterpret_cast<sockaddr*>(&storage), &length) == 0) {
    address_of(storage, ip, port);
  }
}

} // namespace dyncal::services::web
