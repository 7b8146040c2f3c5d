// A server on loopback that takes connections and says nothing, as one does that is stopped.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>

namespace dyncal::inline records {

class SilentServer {
public:
  SilentServer() : listening_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    auto* const any = reinterpret_cast<sockaddr*>(&address_);
    if (bind(listening_, any, size) != 0 || listen(listening_, 64) != 0 ||
        getsockname(listening_, any, &size) != 0) {
      close(listening_);
      throw std::runtime_error("no port to listen at");
    }
  }
  ~SilentServer() { close(listening_); }
  SilentServer(const SilentServer&) = delete;
  SilentServer& operator=(const SilentServer&) = delete;

  [[nodiscard]] int port() const { return ntohs(address_.sin_port); }

private:
  int listening_;
  sockaddr_in address_{};
};

} // namespace dyncal::inline records
