#include "services/checks/doctor/trial_connections.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds apart{25}; // so that they are no burst
constexpr std::chrono::milliseconds in_time_limit{500};
constexpr std::chrono::milliseconds patience{3'200}; // the kernel sends after 0, 1 and 3 s
constexpr unsigned max_trials = 40;
constexpr std::size_t max_hosts = 4;

struct Trial {
  drivers::FileDescriptor connection;
  TriedHost* host;
  Clock::time_point begun;
};

std::optional<sockaddr_in> place_of(const std::string& address, int port) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  return inet_pton(AF_INET, address.c_str(), &place.sin_addr) == 1 ? std::optional(place)
                                                                   : std::nullopt;
}

// Those under way that the other kernel has answered leave the list.
void take_answers(std::vector<Trial>& trials, std::chrono::milliseconds wait) {
  std::vector<pollfd> waiting;
  waiting.reserve(trials.size());
  for (const Trial& trial : trials) {
    waiting.push_back({trial.connection.number(), POLLOUT, 0});
  }
  poll(waiting.data(), waiting.size(), static_cast<int>(wait.count()));
  const auto now = Clock::now();
  for (std::size_t i = trials.size(); i-- > 0;) {
    if (waiting[i].revents == 0) {
      continue;
    }
    int error = 0;
    socklen_t size = sizeof(error);
    getsockopt(waiting[i].fd, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error == 0 || error == ECONNREFUSED) { // not what this host says by itself
      ++(now - trials[i].begun <= in_time_limit ? trials[i].host->in_time : trials[i].host->late);
    }
    trials.erase(trials.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

std::string own_address(int connection) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  std::array<char, INET_ADDRSTRLEN> text{};
  return getsockname(connection, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
                 inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size()) != nullptr
             ? text.data()
             : "";
}

void begin(const sockaddr_in& place, TriedHost& host, std::vector<Trial>& trials) {
  drivers::FileDescriptor connection(
      socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (connection.number() < 0) {
    return;
  }
  const auto begun = Clock::now();
  ++host.begun;
  const int done =
      connect(connection.number(), reinterpret_cast<const sockaddr*>(&place), sizeof(place));
  const int error = done == 0 ? 0 : errno;
  host.own_address = own_address(connection.number());
  if (error == 0 || error == ECONNREFUSED) {
    ++host.in_time;
  } else if (error == EINPROGRESS) {
    trials.push_back({std::move(connection), &host, begun});
  } else if (error == ENETUNREACH) {
    host.has_no_route = true;
  }
}

} // namespace

std::map<std::string, TriedHost> try_hosts(const std::set<std::string>& addresses,
                                           const std::stop_token& stop, int port) {
  std::map<std::string, TriedHost> hosts;
  std::vector<std::pair<sockaddr_in, TriedHost*>> tried;
  for (const std::string& address : addresses) {
    if (const auto place = place_of(address, port); place && hosts.size() < max_hosts) {
      tried.emplace_back(*place, &hosts[address]);
    }
  }
  std::vector<Trial> trials;
  const auto until = Clock::now() + patience;
  for (unsigned i = 0; i < max_trials && !stop.stop_requested(); ++i) {
    const auto next = Clock::now() + apart;
    for (const auto& [place, host] : tried) {
      begin(place, *host, trials);
    }
    for (auto now = Clock::now(); now < next; now = Clock::now()) {
      take_answers(trials, std::chrono::ceil<std::chrono::milliseconds>(next - now));
    }
  }
  for (auto now = Clock::now(); !trials.empty() && now < until && !stop.stop_requested();
       now = Clock::now()) {
    take_answers(trials,
                 std::min(apart, std::chrono::ceil<std::chrono::milliseconds>(until - now)));
  }
  return hosts;
}

} // namespace dyncal::inline checks::doctor
