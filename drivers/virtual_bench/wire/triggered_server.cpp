#include "drivers/virtual_bench/wire/triggered_server.hpp"

#include <algorithm>
#include <cerrno>

#include <sys/socket.h>

#include "drivers/virtual_bench/wire/server_socket.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::size_t max_line = 4096;
constexpr std::size_t max_clients = 4;
constexpr std::size_t max_backlog = std::size_t{16} << 20U;
constexpr std::chrono::milliseconds slow_answer{1000};

bool would_block(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

} // namespace

TriggeredServer::TriggeredServer(const TriggeredSettings& settings)
    : settings_(settings), scope_(settings.trigger),
      scpi_(scope_, settings.trigger.seed, settings.faults), sensor_(settings.sensor) {}

Expected<void> TriggeredServer::open() {
  DYNCAL_TRY(auto scope, listen_tcp(settings_.scope_listen));
  DYNCAL_TRY(auto sensor, listen_tcp(settings_.sensor_listen));
  scope_listener_ = std::move(scope);
  sensor_listener_ = std::move(sensor);
  return {};
}

std::uint16_t TriggeredServer::scope_port() const {
  return local_port(scope_listener_);
}

std::uint16_t TriggeredServer::sensor_port() const {
  return local_port(sensor_listener_);
}

void TriggeredServer::serve() {
  for (const auto& [listener, clients] : {std::pair{&scope_listener_, &scope_clients_},
                                          std::pair{&sensor_listener_, &sensor_clients_}}) {
    if (FileDescriptor client = accept_client(*listener);
        client.is_open() && clients->size() < max_clients) {
      clients->push_back(Client{std::move(client), {}, {}, false, {}});
    }
  }
  scope_clients_.remove_if([this](Client& client) { return !serve_scope(client); });
  sensor_clients_.remove_if([this](Client& client) {
    const bool there = receive(client);
    client.received.clear(); // the sensor takes no orders
    return !there || !transmit(client, client.sending.size());
  });
}

bool TriggeredServer::receive(Client& client) {
  char chunk[4096];
  const ssize_t came = recv(client.socket.number(), chunk, sizeof(chunk), 0);
  if (came == 0 || (came < 0 && !would_block(errno))) {
    return false;
  }
  client.received.append(chunk, static_cast<std::size_t>(std::max<ssize_t>(came, 0)));
  return true;
}

bool TriggeredServer::serve_scope(Client& client) {
  if (!receive(client)) {
    return false;
  }
  for (std::size_t end = client.received.find('\n'); end != std::string::npos && !client.disconnect;
       end = client.received.find('\n')) {
    const OscilloscopeScpi::Reply reply =
        scpi_.execute(std::string_view(client.received).substr(0, end));
    client.received.erase(0, end + 1);
    client.sending += reply.bytes;
    client.disconnect = reply.disconnect;
    if (reply.slow) {
      client.not_before = Clock::now() + slow_answer;
    }
  }
  if (Clock::now() >= client.not_before &&
      !transmit(client,
                settings_.piece_bytes > 0 ? settings_.piece_bytes : client.sending.size())) {
    return false;
  }
  return client.received.size() <= max_line && !(client.disconnect && client.sending.empty());
}

bool TriggeredServer::transmit(Client& client, std::size_t most) const {
  if (client.sending.empty()) {
    return true;
  }
  const ssize_t sent = send(client.socket.number(), client.sending.data(),
                            std::min(most, client.sending.size()), MSG_NOSIGNAL);
  if (sent < 0 && !would_block(errno)) {
    return false;
  }
  client.sending.erase(0, static_cast<std::size_t>(std::max<ssize_t>(sent, 0)));
  return client.sending.size() <= max_backlog;
}

void TriggeredServer::advance_to(double time_s, const Excitation& excitation) {
  if (const auto event = scope_.advance_to(time_s, excitation)) {
    sensor_.trigger(event->output_edge_s);
  }
  if (const auto series = sensor_.advance_to(time_s, excitation)) {
    const std::string bytes = sensor_.wire_form(*series);
    for (Client& client : sensor_clients_) {
      client.sending += bytes;
    }
  }
}

std::vector<int> TriggeredServer::descriptors() const {
  std::vector<int> all{scope_listener_.number(), sensor_listener_.number()};
  for (const auto* clients : {&scope_clients_, &sensor_clients_}) {
    for (const Client& client : *clients) {
      all.push_back(client.socket.number());
    }
  }
  return all;
}

bool TriggeredServer::has_backlog() const {
  const auto waits = [](const Client& client) { return !client.sending.empty(); };
  return std::any_of(scope_clients_.begin(), scope_clients_.end(), waits) ||
         std::any_of(sensor_clients_.begin(), sensor_clients_.end(), waits);
}

} // namespace dyncal::drivers::virtual_bench
