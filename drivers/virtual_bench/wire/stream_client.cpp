#include "drivers/virtual_bench/wire/stream_client.hpp"

#include <bit>
#include <cerrno>
#include <cstring>

#include <sys/socket.h>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr int socket_buffer_bytes = 16384;
constexpr std::uint32_t frame_magic = 0x46534341; // "ACSF"

static_assert(std::endian::native == std::endian::little,
              "frames are little-endian and written as they are");

template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

} // namespace

void StreamClient::connect(FileDescriptor socket, const std::string& description) {
  socket_ = std::move(socket);
  setsockopt(socket_.number(), SOL_SOCKET, SO_SNDBUF, &socket_buffer_bytes,
             sizeof(socket_buffer_bytes));
  backlog_ = description + "\n";
  sent_ = 0;
}

void StreamClient::drop() {
  socket_ = FileDescriptor();
  backlog_.clear();
  sent_ = 0;
}

void StreamClient::send_frame(const AcsSamples& samples) {
  if (!connected() || samples.counts.empty()) {
    return;
  }
  put(backlog_, frame_magic);
  put(backlog_, static_cast<std::uint32_t>(samples.samples()));
  put(backlog_, samples.first_sample);
  backlog_.append(reinterpret_cast<const char*>(samples.counts.data()),
                  samples.counts.size() * sizeof(std::int32_t));
}

void StreamClient::send_end() {
  put(backlog_, frame_magic);
  put(backlog_, std::uint32_t{0});
  put(backlog_, std::uint64_t{0});
}

void StreamClient::serve() {
  if (!connected()) {
    return;
  }
  char ignored[256];
  const ssize_t came = recv(socket_.number(), ignored, sizeof(ignored),
                            0); // a client has nothing to say but that it goes
  if (came == 0 || (came < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
    drop();
    return;
  }
  while (backlog_bytes() > 0) {
    const ssize_t count =
        send(socket_.number(), backlog_.data() + sent_, backlog_bytes(), MSG_NOSIGNAL);
    if (count < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
        drop();
      }
      break;
    }
    sent_ += static_cast<std::size_t>(count);
  }
  if (sent_ == backlog_.size() || sent_ > 65536) {
    backlog_.erase(0, sent_);
    sent_ = 0;
  }
}

} // namespace dyncal::drivers::virtual_bench
