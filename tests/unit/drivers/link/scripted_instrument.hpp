// A TCP instrument for tests: it listens on a port of its own and does with each connection what
// the test says.
#pragma once

#include <arpa/inet.h>
#include <functional>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::drivers {

class ScriptedInstrument {
public:
  // One end of a connection.
  class Client {
  public:
    explicit Client(int socket) : socket_(socket) {}
    void say(const std::string& bytes) const {
      static_cast<void>(send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
    }
    // The next line without its end; empty when the other side has gone.
    [[nodiscard]] std::string hear() {
      for (;;) {
        const std::size_t end = heard_.find('\n');
        if (end != std::string::npos) {
          std::string line = heard_.substr(0, end);
          heard_.erase(0, end + 1);
          return line;
        }
        char chunk[512];
        const ssize_t count = recv(socket_.number(), chunk, sizeof(chunk), 0);
        if (count <= 0) {
          return "";
        }
        heard_.append(chunk, static_cast<std::size_t>(count));
      }
    }

  private:
    FileDescriptor socket_;
    std::string heard_;
  };

  // `serve` is called with the number of the connection, 0 for the first.
  explicit ScriptedInstrument(std::function<void(int, Client&)> serve)
      : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool listens =
        ::bind(listener_.number(), reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0 &&
        ::listen(listener_.number(), 4) == 0;
    EXPECT_TRUE(listens) << "port of a scripted instrument";
    socklen_t size = sizeof(address);
    getsockname(listener_.number(), reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this, serve = std::move(serve)] {
      for (int number = 0;; ++number) {
        const int socket = accept(listener_.number(), nullptr, nullptr);
        if (socket < 0) {
          return;
        }
        Client client(socket);
        serve(number, client);
      }
    });
  }
  ~ScriptedInstrument() {
    shutdown(listener_.number(), SHUT_RDWR);
  } // ends accept(); the thread is joined after this

  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

private:
  FileDescriptor listener_;
  std::uint16_t port_ = 0;
  std::jthread thread_;
};

} // namespace dyncal::drivers
