#include "drivers/link/scpi_connection.hpp"

#include <algorithm>
#include <utility>

#include "drivers/link/scpi_answer.hpp"

namespace dyncal::drivers {
namespace {

constexpr std::chrono::milliseconds waiting_slice{500};
constexpr std::size_t max_line_bytes = 4096;

} // namespace

Expected<ScpiConnection> ScpiConnection::connect(std::string instrument, std::string address,
                                                 std::chrono::milliseconds answer_limit,
                                                 const StopSignal& stop,
                                                 std::chrono::milliseconds connect_limit) {
  auto transport = connect_scpi_transport(address, connect_limit, stop);
  if (!transport) {
    return fail(transport.error().code, instrument + " " + transport.error().message);
  }
  return ScpiConnection(std::move(instrument), std::move(address), answer_limit,
                        std::move(*transport));
}

ScpiConnection::ScpiConnection(std::string instrument, std::string address,
                               std::chrono::milliseconds answer_limit,
                               std::unique_ptr<ScpiTransport> transport)
    : instrument_(std::move(instrument)), address_(std::move(address)), answer_limit_(answer_limit),
      transport_(std::move(transport)) {}

tl::unexpected<Error> ScpiConnection::give_up(const Error& error, const std::string& command) {
  if (!lost_) {
    transport_->abandon();
  }
  lost_ = true;
  return fail(error.code, instrument_ + " " + error.message + " (" + command + ")");
}

tl::unexpected<Error> ScpiConnection::give_up_misunderstood(const std::string& reason,
                                                            const std::string& command) {
  return give_up(Error{ErrorCode::malformed, address_ + ": " + reason}, command);
}

Expected<void> ScpiConnection::send(const std::string& text, std::string_view block) {
  if (lost_) {
    return give_up(Error{ErrorCode::disconnected, address_ + ": the connection is lost"}, text);
  }
  if (auto sent = transport_->send(text + std::string(block) + "\n", answer_limit_); !sent) {
    return give_up(sent.error(), text);
  }
  return {};
}

Expected<void> ScpiConnection::ask(const std::string& query) {
  if (transport_->has_unread()) {
    return give_up_misunderstood("the instrument has answered something that was not asked", query);
  }
  return send(query);
}

Expected<std::string> ScpiConnection::read_answer() {
  if (!while_waiting_ || !transport_->keeps_part_of_line()) {
    return transport_->read_line(max_line_bytes, answer_limit_);
  }
  auto left = answer_limit_;
  for (;;) {
    const auto slice = std::min(left, waiting_slice);
    auto answer = transport_->read_line(max_line_bytes, slice);
    left -= slice;
    if (answer || answer.error().code != ErrorCode::timeout || left.count() <= 0 ||
        !while_waiting_()) {
      return answer;
    }
  }
}

Expected<std::string> ScpiConnection::query(const std::string& text) {
  DYNCAL_TRY(ask(text));
  auto answer = read_answer();
  if (!answer) {
    return give_up(answer.error(), text);
  }
  return answer;
}

Expected<double> ScpiConnection::query_number(const std::string& text) {
  DYNCAL_TRY(const auto answer, query(text));
  auto number = parse_scpi_number(answer);
  if (!number) {
    return give_up_misunderstood(number.error().message, text);
  }
  return number;
}

Expected<void> ScpiConnection::command(const std::string& text, std::string_view block) {
  DYNCAL_TRY(send(text, block));
  DYNCAL_TRY(const auto answer, query(":SYSTem:ERRor?"));
  const auto error = parse_instrument_error(answer);
  if (!error) {
    return give_up_misunderstood(error.error().message, text);
  }
  if (error->code == 0) {
    return {};
  }
  return fail(ErrorCode::refused,
              instrument_ + " " + address_ + " refuses " + text + ": " + shown(answer));
}

Expected<std::vector<char>> ScpiConnection::query_block(const std::string& text,
                                                        std::size_t max_bytes) {
  DYNCAL_TRY(ask(text));
  auto block = read_block(max_bytes);
  if (!block) {
    return give_up(block.error(), text);
  }
  return block;
}

Expected<std::vector<char>> ScpiConnection::read_block(std::size_t max_bytes) {
  const auto malformed = [this](const std::string& message) {
    return fail(ErrorCode::malformed, address_ + ": " + message);
  };
  char header[2];
  DYNCAL_TRY(transport_->read_exactly(header, answer_limit_));
  const auto digit_count = parse_block_digit_count({header, sizeof(header)});
  if (!digit_count) {
    return malformed(digit_count.error().message);
  }
  char digits[9];
  DYNCAL_TRY(transport_->read_exactly({digits, *digit_count}, answer_limit_));
  const auto length = parse_block_length({digits, *digit_count});
  if (!length) {
    return malformed(length.error().message);
  }
  if (*length > max_bytes) {
    return malformed("a block of " + std::to_string(*length) + " bytes where at most " +
                     std::to_string(max_bytes) + " are possible");
  }
  std::vector<char> block(*length);
  DYNCAL_TRY(transport_->read_exactly(block, answer_limit_));
  DYNCAL_TRY(const auto end, transport_->read_line(max_line_bytes, answer_limit_));
  if (!end.empty()) {
    return malformed("a block is longer than the " + std::to_string(*length) +
                     " bytes it announces");
  }
  return block;
}

} // namespace dyncal::drivers
