#include <array>
#include <utility>

#include "drivers/link/scpi_answer.hpp"
#include "drivers/link/tcp_connection.hpp"
#include "drivers/tss/series_source.hpp"
#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::tss {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds connect_limit{3000};
constexpr milliseconds rest_limit{5000};  // for the bytes after a header that has come
constexpr milliseconds leftover_limit{1}; // for what has come already
constexpr std::size_t max_header_bytes = 65'536;

class SocketSource : public SeriesSource {
public:
  SocketSource(std::string address, const StopSignal& stop)
      : address_(std::move(address)), stop_(stop) {}

  Expected<void> discard_pending() override {
    DYNCAL_TRY(connect());
    while (connection_ && connection_->has_unread()) {
      if (auto old = next(leftover_limit);
          !old && old.error().code == ErrorCode::disconnected && stop_.raised()) {
        return fail(old.error());
      }
    }
    return connect();
  }

  Expected<Series> next(milliseconds limit) override {
    DYNCAL_TRY(connect());
    auto line = connection_->read_line(max_header_bytes, limit);
    if (!line) {
      // Nothing has come yet: the connection is as good as before.
      return line.error().code == ErrorCode::timeout && !connection_->has_unread()
                 ? sensor_error(line.error())
                 : disconnect_after(line.error());
    }
    auto header = parse_series_header(*line);
    if (!header) {
      return disconnect_after({header.error().code, address_ + ": " + header.error().message});
    }
    auto bytes = read_block(header->bytes());
    if (!bytes) {
      return disconnect_after(bytes.error());
    }
    auto series = decode_series(std::move(*header), *bytes);
    if (!series) {
      return disconnect_after({series.error().code, address_ + ": " + series.error().message});
    }
    series->received_utc_ns = utc_now_ns();
    return series;
  }

private:
  Expected<void> connect() {
    if (connection_) {
      return {};
    }
    const auto parsed = parse_address(address_);
    if (!parsed) {
      return sensor_error(parsed.error());
    }
    auto connection = TcpConnection::connect(*parsed, connect_limit, stop_);
    if (!connection) {
      return sensor_error(connection.error());
    }
    connection_.emplace(std::move(*connection));
    return {};
  }

  Expected<std::vector<char>> read_block(std::size_t wanted) {
    std::array<char, 2> head{};
    std::array<char, 9> digits{};
    DYNCAL_TRY(connection_->read_exactly(head, rest_limit));
    const auto count = parse_block_digit_count({head.data(), head.size()});
    if (!count) {
      return fail(ErrorCode::malformed, address_ + ": " + count.error().message);
    }
    DYNCAL_TRY(connection_->read_exactly({digits.data(), *count}, rest_limit));
    const auto length = parse_block_length({digits.data(), *count});
    if (!length || *length != wanted) {
      return fail(ErrorCode::malformed,
                  address_ + ": a block of '" + shown({digits.data(), *count}) +
                      "' bytes where the series has " + std::to_string(wanted));
    }
    std::vector<char> bytes(wanted);
    DYNCAL_TRY(connection_->read_exactly(bytes, rest_limit));
    DYNCAL_TRY(const auto end, connection_->read_line(max_header_bytes, rest_limit));
    if (!end.empty()) {
      return fail(ErrorCode::malformed, address_ + ": a series is longer than it announces");
    }
    return bytes;
  }

  static tl::unexpected<Error> sensor_error(const Error& error) {
    return fail(error.code, "time series sensor " + error.message);
  }
  tl::unexpected<Error> disconnect_after(const Error& error) {
    connection_.reset();
    return sensor_error(error);
  }

  std::string address_;
  const StopSignal& stop_;
  std::optional<TcpConnection> connection_;
};

} // namespace

std::unique_ptr<SeriesSource> series_from_socket(std::string address, const StopSignal& stop) {
  return std::make_unique<SocketSource>(std::move(address), stop);
}

} // namespace dyncal::drivers::tss
