#include "drivers/link/scpi_transport.hpp"

#include <utility>

#include "drivers/link/address.hpp"
#include "drivers/link/tcp_connection.hpp"

namespace dyncal::drivers {
namespace {

class SocketTransport : public ScpiTransport {
public:
  explicit SocketTransport(TcpConnection connection) : connection_(std::move(connection)) {}
  Expected<void> send(std::string_view message, std::chrono::milliseconds limit) override {
    return connection_.send_all(message, limit);
  }
  Expected<std::string> read_line(std::size_t max_bytes, std::chrono::milliseconds limit) override {
    return connection_.read_line(max_bytes, limit);
  }
  Expected<void> read_exactly(std::span<char> bytes, std::chrono::milliseconds limit) override {
    return connection_.read_exactly(bytes, limit);
  }
  bool keeps_part_of_line() const override { return true; }
  bool has_unread() override { return connection_.has_unread(); }
  void set_delivery_limit(std::chrono::milliseconds limit) override {
    connection_.set_delivery_limit(limit);
  }
  void abandon() override { connection_.abandon(); }

private:
  TcpConnection connection_;
};

} // namespace

Expected<std::unique_ptr<ScpiTransport>> connect_scpi_transport(const std::string& address,
                                                                std::chrono::milliseconds limit,
                                                                const StopSignal& stop) {
  if (address.starts_with("vxi11:")) {
    return connect_vxi11_transport(address, limit);
  }
  DYNCAL_TRY(const auto parsed, parse_address(address));
  DYNCAL_TRY(auto connection, TcpConnection::connect(parsed, limit, stop));
  return std::make_unique<SocketTransport>(std::move(connection));
}

} // namespace dyncal::drivers
