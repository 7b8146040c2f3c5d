#include "drivers/smartup/receiver.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <utility>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers::smartup {

namespace {

constexpr std::size_t batch_size = 64;     // datagrams per recvmmsg
constexpr std::size_t max_datagram = 2048; // a unit sends 1000 bytes at most
constexpr int tick_ms = 25;
constexpr int rest_ms = 5; // a tenth of a block: waking up was a tenth of all processor time at 2
constexpr std::size_t rest_worthwhile = 2; // datagrams at one wake-up, from which on batches pay

template <class Clock>
std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

HostTime host_time() {
  return {now_ns<std::chrono::steady_clock>(), now_ns<std::chrono::system_clock>()};
}

sockaddr_in socket_address(ListenAddress listen) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(listen.address);
  address.sin_port = htons(listen.port);
  return address;
}

// The sockets interface takes every address family through this one type.
sockaddr* generic(sockaddr_in& address) {
  return reinterpret_cast<sockaddr*>(&address);
}

Error cannot_listen(const std::string& listen, int error) {
  std::string reason = std::strerror(error);
  if (error == EADDRINUSE) {
    reason = "another program uses this port already: stop it, or give this source another port";
  }
  if (error == EADDRNOTAVAIL) {
    reason = "this host has no such address: use one of its own, or 0.0.0.0 for all";
  }
  if (error == EACCES) {
    reason = "not permitted: use a port above 1023, or run with the right to use lower ones";
  }
  return {ErrorCode::refused, "cannot listen at UDP " + listen + ": " + reason};
}

} // namespace

Expected<ListenAddress> parse_listen_address(const std::string& text) {
  const auto colon = text.rfind(':');
  const auto bad = [&] {
    return fail(ErrorCode::invalid_setting,
                "cannot listen at '" + text + "': write IPV4-ADDRESS:PORT, e.g. 0.0.0.0:7654");
  };
  if (colon == std::string::npos) {
    return bad();
  }
  ListenAddress listen;
  const char* begin = text.data() + colon + 1;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(begin, end, listen.port);
  if (error != std::errc() || rest != end || begin == end) {
    return bad();
  }
  if (colon == 0) {
    return listen;
  }
  in_addr address{};
  if (inet_pton(AF_INET, text.substr(0, colon).c_str(), &address) != 1) {
    return bad();
  }
  listen.address = ntohl(address.s_addr);
  return listen;
}

// Memory for one call of recvmmsg.
class Receiver::Batch {
public:
  Batch() {
    for (std::size_t i = 0; i < batch_size; ++i) {
      parts_[i] = {bytes_.data() + i * max_datagram, max_datagram};
      headers_[i].msg_hdr.msg_iov = &parts_[i];
      headers_[i].msg_hdr.msg_iovlen = 1;
      headers_[i].msg_hdr.msg_name = &senders_[i];
    }
  }

  // Datagrams received, 0 when there are none.
  std::size_t receive(int descriptor) {
    for (std::size_t i = 0; i < batch_size; ++i) {
      headers_[i].msg_hdr.msg_namelen = sizeof senders_[i];
      headers_[i].msg_hdr.msg_control = controls_[i].data();
      headers_[i].msg_hdr.msg_controllen = controls_[i].size();
    }
    const int count = recvmmsg(descriptor, headers_.data(), batch_size, MSG_DONTWAIT, nullptr);
    return count > 0 ? static_cast<std::size_t>(count) : 0;
  }

  [[nodiscard]] std::span<const std::uint8_t> datagram(std::size_t i) const {
    return {bytes_.data() + i * max_datagram, headers_[i].msg_len};
  }
  [[nodiscard]] bool cut_off(std::size_t i) const {
    return (headers_[i].msg_hdr.msg_flags & MSG_TRUNC) != 0;
  }
  [[nodiscard]] Sender sender(std::size_t i) const {
    return {ntohl(senders_[i].sin_addr.s_addr), ntohs(senders_[i].sin_port)};
  }

  // The socket's own count of datagrams that did not fit its buffer, as it was when this one came
  // (32 bits, wraps).
  [[nodiscard]] std::optional<std::uint32_t> dropped(std::size_t i) {
    for (cmsghdr* part = CMSG_FIRSTHDR(&headers_[i].msg_hdr); part != nullptr;
         part = CMSG_NXTHDR(&headers_[i].msg_hdr, part)) {
      if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_RXQ_OVFL) {
        continue;
      }
      std::uint32_t count = 0;
      std::memcpy(&count, CMSG_DATA(part), sizeof count);
      return count;
    }
    return std::nullopt;
  }

private:
  std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(batch_size * max_datagram);
  std::array<iovec, batch_size> parts_{};
  std::array<mmsghdr, batch_size> headers_{};
  std::array<sockaddr_in, batch_size> senders_{};
  alignas(cmsghdr)
      std::array<std::array<char, CMSG_SPACE(sizeof(std::uint32_t))>, batch_size> controls_{};
};

class Receiver::Socket {
public:
  static Expected<std::unique_ptr<Socket>> open(Endpoint endpoint) {
    DYNCAL_TRY(auto listen, parse_listen_address(endpoint.listen));
    FileDescriptor owner(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int descriptor = owner.number();
    if (!owner.is_open()) {
      return fail(cannot_listen(endpoint.listen, errno));
    }
    auto opened = std::unique_ptr<Socket>(
        new Socket(std::move(owner), std::move(endpoint.wanted), *endpoint.observer));
    const int wanted = endpoint.receive_buffer_bytes;
    const int on = 1;
    // The first needs a privilege and passes the system's limit, the second is capped by it.
    if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0) {
      setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
    }
    setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    sockaddr_in address = socket_address(listen);
    if (bind(descriptor, generic(address), sizeof address) != 0) {
      return fail(cannot_listen(endpoint.listen, errno));
    }
    return opened;
  }

  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_.number(); }

  [[nodiscard]] std::uint16_t port() const {
    sockaddr_in address{};
    socklen_t length = sizeof address;
    return getsockname(descriptor(), generic(address), &length) == 0 ? ntohs(address.sin_port)
                                                                     : std::uint16_t{0};
  }

  [[nodiscard]] int receive_buffer_bytes() const {
    int bytes = 0;
    socklen_t length = sizeof bytes;
    return getsockopt(descriptor(), SOL_SOCKET, SO_RCVBUF, &bytes, &length) == 0 ? bytes : 0;
  }

  // Everything that waits in the socket; how many datagrams that were.
  std::size_t drain(Batch& batch) {
    std::size_t total = 0;
    std::size_t count = batch_size;
    // Bounded, so that a flood at this socket cannot starve the others and the stop.
    for (int round = 0; round < rounds && count == batch_size; ++round) {
      count = batch.receive(descriptor());
      const HostTime now = host_time();
      for (std::size_t i = 0; i < count; ++i) {
        take(batch, i, now);
      }
      total += count;
    }
    return total;
  }

  Reception& reception() { return reception_; }

private:
  static constexpr int rounds = 64;

  Socket(FileDescriptor descriptor, std::vector<WantedSensor> wanted, ReceptionObserver& observer)
      : descriptor_(std::move(descriptor)), reception_(std::move(wanted), observer) {}

  void take(Batch& batch, std::size_t i, HostTime now) {
    if (const auto dropped = batch.dropped(i)) {
      dropped_ += *dropped - last_dropped_; // differences of 32-bit counts survive the wrap
      last_dropped_ = *dropped;
      reception_.set_dropped_by_kernel(dropped_);
    }
    if (batch.cut_off(i)) {
      reception_.add_too_long();
    } else {
      reception_.take(batch.datagram(i), batch.sender(i), now);
    }
  }

  const FileDescriptor descriptor_;
  Reception reception_;
  std::uint32_t last_dropped_ = 0;
  std::uint64_t dropped_ = 0;
};

Receiver::Receiver() = default;

Expected<std::unique_ptr<Receiver>> Receiver::create(std::vector<Endpoint> endpoints) {
  auto receiver = std::unique_ptr<Receiver>(new Receiver());
  for (auto& endpoint : endpoints) {
    DYNCAL_TRY(auto opened, Socket::open(std::move(endpoint)));
    receiver->sockets_.push_back(std::move(opened));
  }
  return receiver;
}

Receiver::~Receiver() {
  stop();
}

std::uint16_t Receiver::port(std::size_t endpoint) const {
  return sockets_.at(endpoint)->port();
}

int Receiver::receive_buffer_bytes(std::size_t endpoint) const {
  return sockets_.at(endpoint)->receive_buffer_bytes();
}

void Receiver::start() {
  if (!thread_.joinable()) {
    thread_ = std::thread([this] { run(); });
  }
}

void Receiver::stop() {
  if (!thread_.joinable()) {
    return;
  }
  stop_.raise();
  thread_.join();
}

void Receiver::run() {
  Batch batch;
  std::vector<pollfd> events{{stop_.descriptor(), POLLIN, 0}};
  for (const auto& socket : sockets_) {
    events.push_back({socket->descriptor(), POLLIN, 0});
  }
  std::int64_t next_tick_ns = 0;
  while (true) {
    poll(events.data(), events.size(), tick_ms);
    std::size_t received = 0;
    for (auto& socket : sockets_) {
      received += socket->drain(batch);
    }
    const HostTime now = host_time();
    if (now.monotonic_ns >= next_tick_ns) {
      for (auto& socket : sockets_) {
        socket->reception().tick(now);
      }
      next_tick_ns = now.monotonic_ns + tick_ms * std::int64_t{1'000'000};
    }
    if (received >= rest_worthwhile) {
      poll(events.data(), 1, rest_ms); // the stop alone
    }
    if ((events[0].revents & POLLIN) != 0) {
      break;
    }
  }
  for (auto& socket : sockets_) {
    socket->reception().finish(host_time());
  }
}

} // namespace dyncal::drivers::smartup
