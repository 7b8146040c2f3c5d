// Fetches what a program offers to Prometheus, over HTTP, and reads it. For tests.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <string>

namespace dyncal::tests {

// The whole answer to "GET /metrics"; empty if nobody listens there.
inline std::string fetch_metrics(int port) {
  const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  const std::string request = "GET /metrics HTTP/1.0\r\nHost: localhost\r\n\r\n";
  if (connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 &&
      send(descriptor, request.data(), request.size(), MSG_NOSIGNAL) ==
          static_cast<ssize_t>(request.size())) {
    std::array<char, 4096> buffer{};
    for (ssize_t size = 0; (size = recv(descriptor, buffer.data(), buffer.size(), 0)) > 0;) {
      answer.append(buffer.data(), static_cast<std::size_t>(size));
    }
  }
  close(descriptor);
  return answer;
}

// Values by name and labels as they are written: dyncal_x{bench="acc-1"}.
inline std::map<std::string, double> metrics_in(const std::string& answer) {
  std::map<std::string, double> values;
  std::istringstream lines(answer.substr(std::min(answer.find("\r\n\r\n"), answer.size())));
  for (std::string line; std::getline(lines, line);) {
    const auto space = line.rfind(' ');
    if (!line.empty() && line[0] != '#' && line[0] != '\r' && space != std::string::npos) {
      values[line.substr(0, space)] = std::stod(line.substr(space + 1));
    }
  }
  return values;
}

} // namespace dyncal::tests
