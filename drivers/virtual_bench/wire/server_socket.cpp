#include "drivers/virtual_bench/wire/server_socket.hpp"

#include <cerrno>
#include <cstring>
#include <memory>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace dyncal::drivers::virtual_bench {
namespace {

// Of an Ethernet. One of the loopback interface is longer than the small buffer of a stream
// (stream_client.hpp), which then waits 40 ms for each answer: 1.9 MB/s.
constexpr int max_segment_bytes = 1448;

// Resolves the address and hands each result to `use` until it returns an open descriptor.
template <class Use>
Expected<FileDescriptor> open_socket(const Address& address, int type, int flags, Use use) {
  addrinfo hints{};
  hints.ai_socktype = type;
  hints.ai_flags = flags;
  addrinfo* found = nullptr;
  const int status =
      getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &hints, &found);
  if (status != 0) {
    return fail(ErrorCode::not_found,
                address.text() + ": no host of this name (" + gai_strerror(status) + ")");
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> results(found, &freeaddrinfo);
  int problem = EADDRNOTAVAIL;
  for (const addrinfo* result = found; result != nullptr; result = result->ai_next) {
    FileDescriptor socket(::socket(result->ai_family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (socket.is_open() && use(socket.number(), *result)) {
      return socket;
    }
    problem = errno;
  }
  return fail(ErrorCode::refused, address.text() + ": " + std::strerror(problem));
}

} // namespace

Expected<FileDescriptor> listen_tcp(const Address& address) {
  return open_socket(address, SOCK_STREAM, AI_PASSIVE, [](int socket, const addrinfo& result) {
    const int on = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    setsockopt(socket, IPPROTO_TCP, TCP_MAXSEG, &max_segment_bytes, sizeof(max_segment_bytes));
    return bind(socket, result.ai_addr, result.ai_addrlen) == 0 && listen(socket, 8) == 0;
  });
}

std::uint16_t local_port(const FileDescriptor& socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  if (getsockname(socket.number(), reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return 0;
  }
  if (address.ss_family == AF_INET6) {
    return ntohs(reinterpret_cast<const sockaddr_in6*>(&address)->sin6_port);
  }
  return ntohs(reinterpret_cast<const sockaddr_in*>(&address)->sin_port);
}

FileDescriptor accept_client(const FileDescriptor& listener) {
  FileDescriptor client(accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (client.is_open()) {
    const int on = 1;
    setsockopt(client.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  }
  return client;
}

Expected<FileDescriptor> connect_udp(const Address& address) {
  return open_socket(address, SOCK_DGRAM, 0, [](int socket, const addrinfo& result) {
    return connect(socket, result.ai_addr, result.ai_addrlen) == 0;
  });
}

} // namespace dyncal::drivers::virtual_bench
