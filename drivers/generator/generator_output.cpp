#include "drivers/generator/generator_output.hpp"

#include <chrono>
#include <string_view>

#include "analysis/base/text.hpp"
#include "drivers/link/scpi_answer.hpp"
#include "drivers/link/scpi_connection.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers::generator {
namespace {

using std::chrono::milliseconds;

// One retransmission of TCP (1 s) fits, and an instrument that answers late; it is tried again.
constexpr milliseconds connect_limit{1500};
constexpr milliseconds answer_limit{2000};

Expected<ScpiConnection> connect(const std::string& address, const StopSignal& never_raised) {
  auto connection =
      ScpiConnection::connect("generator", address, answer_limit, never_raised, connect_limit);
  if (connection) {
    connection->set_delivery_limit(answer_limit); // an OFF that comes later may meet the next run
  }
  return connection;
}

} // namespace

std::optional<bool> parse_output_state(const std::string& answer) {
  const std::string_view state = trimmed(answer);
  if (state == "ON" || state == "1") {
    return true;
  }
  return state == "OFF" || state == "0" ? std::optional(false) : std::nullopt;
}

Error still_on(const std::string& address) {
  return {ErrorCode::refused,
          "generator " + address +
              " takes :OUTPut1 OFF without an error, but its OUTPUT IS STILL ON: switch it off by "
              "hand; is its front panel locked, or does it need another command?"};
}

Expected<OutputReading> read_output(const std::string& address) {
  const StopSignal never_raised;
  DYNCAL_TRY(auto connection, connect(address, never_raised));
  DYNCAL_TRY(const auto state, connection.query(":OUTPut1?"));
  OutputReading reading;
  reading.is_on = parse_output_state(state);
  const auto frequency = connection.query(":SOURce1:FREQuency?");
  const auto voltage = frequency ? connection.query(":SOURce1:VOLTage?") : frequency;
  if (!voltage) {
    return reading; // whether it is on is what matters
  }
  if (const auto frequency_hz = parse_scpi_number(*frequency)) {
    const auto voltage_vpp = parse_scpi_number(*voltage);
    reading.settings = {*frequency_hz, voltage_vpp ? std::optional(*voltage_vpp) : std::nullopt};
  }
  return reading;
}

Expected<void> switch_output_off(const std::string& address) {
  const StopSignal never_raised;
  DYNCAL_TRY(auto connection, connect(address, never_raised));
  DYNCAL_TRY(const auto state, connection.send(":OUTPut1 OFF").and_then([&] {
    return connection.query(":OUTPut1?");
  }));
  if (parse_output_state(state).value_or(false)) {
    return fail(still_on(address));
  }
  return {};
}

} // namespace dyncal::drivers::generator
