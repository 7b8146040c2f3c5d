// One line to an instrument at a port of 127.0.0.1, and its answer, on a connection of its own:
// what a test sees beside the program that drives the instrument.
#pragma once

#include <arpa/inet.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

namespace dyncal::tests {

// Empty where the line is no question, or nobody answers.
inline std::string ask_instrument(int port, const std::string& query) {
  const int socket_number = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  const std::string line = query + "\n";
  if (connect(socket_number, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0 &&
      send(socket_number, line.data(), line.size(), MSG_NOSIGNAL) ==
          static_cast<ssize_t>(line.size())) {
    for (char byte = 0;
         query.ends_with('?') && recv(socket_number, &byte, 1, 0) == 1 && byte != '\n';) {
      answer += byte;
    }
  }
  close(socket_number);
  return answer;
}

} // namespace dyncal::tests
