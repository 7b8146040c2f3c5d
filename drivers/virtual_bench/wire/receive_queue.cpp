#include "drivers/virtual_bench/wire/receive_queue.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

namespace dyncal::drivers::virtual_bench {
namespace {

// The hexadecimal number behind the last colon, e.g. the port of "0100007F:1DE6" or the receive
// queue of "00000000:00000240".
std::size_t behind_colon(const std::string& word) {
  std::size_t value = 0;
  const std::size_t colon = word.rfind(':');
  if (colon != std::string::npos) {
    std::from_chars(word.data() + colon + 1, word.data() + word.size(), value, 16);
  }
  return value;
}

} // namespace

std::size_t udp_receive_queue(std::istream& table, std::uint16_t port) {
  std::size_t fullest = 0;
  std::string line;
  std::getline(table, line); // the names of the columns
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string slot;
    std::string local;
    std::string remote;
    std::string state;
    std::string queues; // transmit:receive
    if (words >> slot >> local >> remote >> state >> queues && behind_colon(local) == port) {
      fullest = std::max(fullest, behind_colon(queues));
    }
  }
  return fullest;
}

std::size_t udp_receive_queue(std::uint16_t port) {
  std::ifstream udp("/proc/net/udp");
  std::ifstream udp6("/proc/net/udp6");
  return std::max(udp_receive_queue(udp, port), udp_receive_queue(udp6, port));
}

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

} // namespace dyncal::drivers::virtual_bench
