#include "drivers/virtual_bench/wire/line_clients.hpp"

#include <algorithm>
#include <cerrno>

#include <sys/socket.h>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::size_t max_line = 4096 + 2 * WaveformMemory::max_packet_points;
constexpr std::size_t max_clients = 16;
constexpr std::chrono::milliseconds max_wait{500};

bool would_block(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

} // namespace

void LineClients::add(FileDescriptor socket) {
  if (clients_.size() < max_clients) {
    clients_.push_back(Client{std::move(socket), {}, {}, {}, {}});
  }
}

void LineClients::serve(double bench_time_s) {
  clients_.remove_if([&](Client& client) { return !serve(client, bench_time_s); });
}

bool LineClients::serve(Client& client, double bench_time_s) {
  char chunk[2048];
  const ssize_t came = recv(client.socket.number(), chunk, sizeof(chunk), 0);
  if (came == 0 || (came < 0 && !would_block(errno))) {
    return false;
  }
  if (came > 0) {
    client.received.append(chunk, static_cast<std::size_t>(came));
  }
  if (client.wait_until_s && (bench_time_s >= *client.wait_until_s ||
                              std::chrono::steady_clock::now() >= client.wait_ends)) {
    client.answers += ScpiInstrument::time_text(bench_time_s) + "\n";
    client.wait_until_s.reset();
  }
  execute_lines(client, bench_time_s);
  if (!client.answers.empty()) {
    const ssize_t sent =
        send(client.socket.number(), client.answers.data(), client.answers.size(), MSG_NOSIGNAL);
    if (sent < 0 && !would_block(errno)) {
      return false;
    }
    client.answers.erase(0, static_cast<std::size_t>(std::max<ssize_t>(sent, 0)));
  }
  return client.received.size() <= max_line && client.answers.size() <= max_line;
}

void LineClients::execute_lines(Client& client, double bench_time_s) {
  std::size_t end = 0;
  while (!client.wait_until_s && (end = end_of_line(client.received)) != std::string::npos) {
    const ScpiInstrument::Reply reply =
        instrument_.execute(std::string_view(client.received).substr(0, end));
    client.received.erase(0, end + 1);
    if (reply.line) {
      client.answers += *reply.line + "\n";
    }
    if (reply.wait_until_s && *reply.wait_until_s <= bench_time_s) {
      client.answers += ScpiInstrument::time_text(bench_time_s) + "\n";
    } else if (reply.wait_until_s) {
      client.wait_until_s = reply.wait_until_s;
      client.wait_ends = std::chrono::steady_clock::now() + max_wait;
    }
  }
}

std::optional<double> LineClients::earliest_wait_s() const {
  std::optional<double> earliest;
  for (const Client& client : clients_) {
    if (client.wait_until_s && (!earliest || *client.wait_until_s < *earliest)) {
      earliest = client.wait_until_s;
    }
  }
  return earliest;
}

std::vector<int> LineClients::descriptors() const {
  std::vector<int> all;
  for (const Client& client : clients_) {
    all.push_back(client.socket.number());
  }
  return all;
}

} // namespace dyncal::drivers::virtual_bench
