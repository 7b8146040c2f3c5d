#include "drivers/generator/scpi_generator.hpp"

#include <array>
#include <charconv>
#include <utility>

#include "drivers/generator/generator_output.hpp"
#include "drivers/link/scpi_answer.hpp"

namespace dyncal::drivers::generator {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds answer_limit{8000};
constexpr milliseconds connect_limit{4000}; // and for each answer meanwhile; it is tried again
constexpr milliseconds delivery_limit{2000};
constexpr double question_interval_s = 1.0;

// What another program may have left: burst, sweep, modulations, offset, phase and polarity, in the
// words of the DG4000, the DG1000Z and the 33500.
constexpr std::array resets{
    ":SOURce1:BURSt:STATe OFF",  ":SOURce1:SWEep:STATe OFF", ":SOURce1:MOD:STATe OFF",
    ":SOURce1:AM:STATe OFF",     ":SOURce1:FM:STATe OFF",    ":SOURce1:PM:STATe OFF",
    ":SOURce1:VOLTage:OFFSet 0", ":SOURce1:PHASe 0",         ":OUTPut1:POLarity NORMal",
};

} // namespace

Expected<std::unique_ptr<ScpiGenerator>> ScpiGenerator::connect(const std::string& address) {
  std::unique_ptr<ScpiGenerator> generator(new ScpiGenerator());
  generator->address_ = address;
  if (auto connected = generator->reconnect(); !connected) {
    return fail(connected.error());
  }
  generator->choose_clock();
  return generator;
}

ScpiGenerator::~ScpiGenerator() {
  if (connection_) {
    // Nothing can be done about a failure here; whoever needs to know calls set_output(false)
    // first.
    static_cast<void>(command(":OUTPut1 OFF"));
  }
}

void ScpiGenerator::choose_clock() {
  // Only a virtual bench has a time of its own; other instruments do not answer the query or report
  // an error.
  has_bench_clock_ = identity_.find("dyncal virtual bench") != std::string::npos;
}

Expected<void> ScpiGenerator::reconnect() {
  auto connection =
      ScpiConnection::connect("generator", address_, connect_limit, never_raised_, connect_limit);
  if (!connection) {
    return fail(connection.error());
  }
  connection->set_delivery_limit(delivery_limit);
  connection->call_while_waiting([this] { return go_on_waiting(); });
  const auto identity = connection->query("*IDN?");
  if (!identity) {
    return fail(identity.error());
  }
  identity_ = *identity;
  // An instrument that was switched off in between has forgotten all of this.
  for (const char* setting : {":OUTPut1 OFF", ":OUTPut1:LOAD INFinity",
                              ":SOURce1:FUNCtion SINusoid", ":SOURce1:VOLTage:UNIT VPP"}) {
    if (auto done = connection->command(setting); !done) {
      return done;
    }
  }
  for (const char* reset : resets) {
    if (auto done = connection->command(reset); !done && connection->lost()) {
      return done; // what is refused is nothing that this instrument has
    }
  }
  connection->set_answer_limit(answer_limit);
  connection_.emplace(std::move(*connection));
  return confirm_off();
}

Expected<std::optional<bool>> ScpiGenerator::output_is_on() {
  return query(":OUTPut1?").map(parse_output_state);
}

Expected<void> ScpiGenerator::confirm_off() {
  const auto on = output_is_on();
  if (!on) {
    return fail(on.error());
  }
  if (on->value_or(false)) {
    return fail(still_on(address_));
  }
  return {};
}

Expected<void> ScpiGenerator::confirm_on() {
  const auto on = output_is_on();
  if (!on) {
    return fail(on.error());
  }
  if (!on->value_or(true)) {
    return fail(ErrorCode::refused, "generator " + address_ +
                                        " answers that its output is off, which was switched on: "
                                        "by its guard, or at its front panel?");
  }
  return {};
}

Expected<std::string> ScpiGenerator::query(const std::string& text) {
  if (connection_->lost()) {
    if (auto connected = reconnect(); !connected) {
      return fail(connected.error());
    }
  }
  return connection_->query(text);
}

Expected<void> ScpiGenerator::command(const std::string& text) {
  if (connection_->lost()) {
    if (auto connected = reconnect(); !connected) {
      return connected;
    }
  }
  return connection_->command(text);
}

Expected<void> ScpiGenerator::set_frequency(const std::string& decimal_hz) {
  return command(":SOURce1:FREQuency " + decimal_hz);
}

Expected<void> ScpiGenerator::set_amplitude_v(double amplitude_v) {
  if (!(amplitude_v >= 0.0 && amplitude_v <= 1000.0)) {
    return fail(ErrorCode::invalid_setting, "generator: invalid amplitude " +
                                                scpi_decimal(amplitude_v) +
                                                " V: must be between 0 and 1000 V");
  }
  return command(":SOURce1:VOLTage " + scpi_decimal(2.0 * amplitude_v));
}

Expected<void> ScpiGenerator::set_output(bool on) {
  is_on_ = on;
  if (on) {
    return command(":OUTPut1 ON");
  }
  return command(":OUTPut1 OFF").and_then([this] { return confirm_off(); });
}

Expected<void> ScpiGenerator::set_rectangle(bool rectangle) {
  return command(rectangle ? ":SOURce1:FUNCtion SQUare" : ":SOURce1:FUNCtion SINusoid");
}

Expected<double> ScpiGenerator::query_bench_time(const std::string& text) {
  asks_time_ = true;
  const auto answer = query(text);
  asks_time_ = false;
  if (!answer) {
    return fail(answer.error());
  }
  double time_s = 0.0;
  const auto [end, status] =
      std::from_chars(answer->data(), answer->data() + answer->size(), time_s);
  if (status != std::errc()) {
    return fail(ErrorCode::malformed,
                "generator " + address_ + " answers " + text + " with '" + *answer + "'");
  }
  return time_s;
}

void ScpiGenerator::call_while_waiting(const std::function<bool(Awaited)>& callback) {
  while_waiting_ = callback;
}

bool ScpiGenerator::go_on_waiting() {
  return !while_waiting_ || while_waiting_(asks_time_ ? Awaited::bench_time : Awaited::answer) ||
         !asks_time_;
}

Expected<double> ScpiGenerator::clock_now_s() {
  if (has_bench_clock_) {
    return query_bench_time(":BENCh:TIME?");
  }
  return host_clock_.now_s();
}

Expected<double> ScpiGenerator::wait_until_s(double time_s, std::stop_token stop) {
  if (!has_bench_clock_) {
    const double now_s = host_clock_.wait_until_s(time_s, stop);
    if (is_on_ && now_s - asked_s_ >= question_interval_s) {
      asked_s_ = now_s;
      return confirm_on().map([&] { return host_clock_.now_s(); });
    }
    return now_s;
  }
  for (;;) {
    // The virtual bench answers :BENCh:WAIT? when the time has come, at the latest after half a
    // second of the host.
    auto now_s = query_bench_time(":BENCh:WAIT? " + scpi_decimal(time_s));
    if (!now_s || *now_s >= time_s || stop.stop_requested()) {
      return now_s;
    }
  }
}

} // namespace dyncal::drivers::generator
