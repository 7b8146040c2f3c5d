#include "drivers/generator/scpi_generator.hpp"

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "drivers/generator/arbitrary_waveform.hpp"
#include "drivers/generator/generator_output.hpp"
#include "drivers/link/scpi_answer.hpp"

namespace dyncal::drivers::generator {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds answer_limit{8000};
constexpr milliseconds connect_limit{4000}; // and for each answer meanwhile; it is tried again
constexpr milliseconds delivery_limit{2000};
// Of an output that is on. Anyone who conducts waits in turns of 0.4 s and says between them that
// it has hold of the output, which the answer of every turn makes true.
constexpr double question_interval_s = 0.3;

// Of an unknown instrument to a question that it may not know.
constexpr milliseconds unknown_limit{1000};

} // namespace

Expected<std::unique_ptr<ScpiGenerator>> ScpiGenerator::connect(const std::string& address,
                                                                double maximum_voltage_v) {
  std::unique_ptr<ScpiGenerator> generator(new ScpiGenerator());
  generator->address_ = address;
  generator->maximum_voltage_v_ = maximum_voltage_v;
  DYNCAL_TRY(generator->reconnect());
  generator->choose_clock();
  return generator;
}

ScpiGenerator::~ScpiGenerator() {
  if (connection_) {
    // Nothing can be done about a failure here; anyone who needs to know calls set_output(false)
    // first.
    switches_off_ = true;
    static_cast<void>(command(":OUTPut1 OFF"));
  }
}

void ScpiGenerator::choose_clock() {
  // Only a virtual bench has a time of its own; other instruments do not answer the query or report
  // an error.
  has_bench_clock_ = identity_.find("dyncal virtual bench") != std::string::npos;
}

Expected<void> ScpiGenerator::reconnect() {
  has_waveform_ = false;
  DYNCAL_TRY(auto connection, ScpiConnection::connect("generator", address_, connect_limit,
                                                      never_raised_, connect_limit));
  connection.set_delivery_limit(delivery_limit);
  connection.call_while_waiting([this] { return go_on_waiting(); });
  if (auto ready = set_up(connection); !ready) {
    const bool knew_no_question = connection.lost() && ready.error().code == ErrorCode::timeout &&
                                  reads_back_ && !family_of(identity_).is_known;
    if (!knew_no_question) {
      return ready;
    }
    reads_back_ = false;
    return reconnect();
  }
  connection.set_answer_limit(answer_limit);
  connection_.emplace(std::move(connection));
  return confirm_off();
}

Expected<void> ScpiGenerator::set_up(ScpiConnection& connection) {
  // First of all, for one that answers nothing any more may still listen.
  DYNCAL_TRY(identity_,
             connection.send(":OUTPut1 OFF").and_then([&] { return connection.query("*IDN?"); }));
  // An instrument that was switched off in between has forgotten all of this.
  for (const char* setting : {":OUTPut1 OFF", ":OUTPut1:LOAD INFinity",
                              ":SOURce1:FUNCtion SINusoid", ":SOURce1:VOLTage:UNIT VPP"}) {
    DYNCAL_TRY(connection.command(setting));
  }
  return reset(connection);
}

Expected<void> ScpiGenerator::reset(ScpiConnection& connection) {
  const GeneratorFamily& family = family_of(identity_);
  answers_offset_ = false;
  for (const LeftOverState& state : family.states) {
    if (auto done = connection.command(state.reset); !done) {
      if (connection.lost()) {
        return done;
      }
      continue; // it has no such state
    }
    if (!reads_back_) {
      continue;
    }
    connection.set_answer_limit(family.is_known ? connect_limit : unknown_limit);
    const auto answer = connection.query(state.query);
    connection.set_answer_limit(connect_limit);
    DYNCAL_TRY(answer);
    const auto is_reset = says_reset(*answer);
    if (!is_reset.value_or(true)) {
      return fail(ErrorCode::refused, "generator " + address_ + " takes " + state.reset +
                                          " without an error, but answers " + state.query +
                                          " with '" + shown(*answer) +
                                          "': what another program left in it (" + state.name +
                                          ") would reach the exciter; reset it by hand");
    }
    answers_offset_ =
        answers_offset_ || (is_reset && std::string_view(state.query) == offset_query);
  }
  return {};
}

Expected<std::optional<bool>> ScpiGenerator::output_is_on() {
  return query(":OUTPut1?").map(parse_output_state);
}

Expected<void> ScpiGenerator::confirm_off() {
  DYNCAL_TRY(const auto on, output_is_on());
  if (on.value_or(false)) {
    return fail(still_on(address_));
  }
  return {};
}

Expected<void> ScpiGenerator::confirm_on() {
  DYNCAL_TRY(const auto on, output_is_on());
  if (!on.value_or(true)) {
    return fail(ErrorCode::refused, "generator " + address_ +
                                        " answers that its output is off, which was switched on: "
                                        "by its guard, or at its front panel?");
  }
  return {};
}

Expected<std::string> ScpiGenerator::query(const std::string& text) {
  if (connection_->lost()) {
    DYNCAL_TRY(reconnect());
  }
  return connection_->query(text);
}

Expected<void> ScpiGenerator::command(const std::string& text) {
  if (connection_->lost()) {
    DYNCAL_TRY(reconnect());
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
  DYNCAL_TRY(check_voltage(amplitude_v));
  amplitude_v_ = amplitude_v;
  return command(":SOURce1:VOLTage " + scpi_decimal(2.0 * amplitude_v));
}

Expected<void> ScpiGenerator::check_voltage(double amplitude_v) const {
  if (amplitude_v + std::abs(offset_v_) <= maximum_voltage_v_) {
    return {};
  }
  return fail(ErrorCode::invalid_setting,
              "generator: " + scpi_decimal(amplitude_v) + " V amplitude and " +
                  scpi_decimal(offset_v_) +
                  " V DC offset are above generator.maximum_voltage_v = " +
                  scpi_decimal(maximum_voltage_v_));
}

// A person may have set an offset since the instrument was connected.
Expected<void> ScpiGenerator::check_before_on() {
  if (!answers_offset_) {
    return {};
  }
  DYNCAL_TRY(const auto answer, query(offset_query));
  const auto offset_v = parse_scpi_number(answer);
  if (offset_v && std::abs(*offset_v) > reset_rounding) {
    return fail(ErrorCode::refused,
                "generator " + address_ + " answers that its DC offset is " +
                    scpi_decimal(*offset_v) +
                    " V, which was reset: the output is not switched on; was it set by hand?");
  }
  offset_v_ = offset_v.value_or(0.0);
  return check_voltage(amplitude_v_);
}

Expected<void> ScpiGenerator::switch_on() {
  if (!wants_waveform_) {
    is_on_ = true;
    return command(":OUTPut1 ON");
  }
  if (!has_waveform_ || connection_->lost()) {
    return fail(ErrorCode::disconnected,
                "generator " + address_ +
                    " was connected anew and no longer has its waveform; it is loaded once more");
  }
  is_on_ = true;
  return connection_->command(":OUTPut1 ON"); // and over no other connection
}

Expected<void> ScpiGenerator::set_output(bool on) {
  is_on_ = false;
  if (on) {
    return check_before_on().and_then([this] { return switch_on(); });
  }
  switches_off_ = true;
  auto off = command(":OUTPut1 OFF").and_then([this] { return confirm_off(); });
  switches_off_ = false;
  return off;
}

Expected<void> ScpiGenerator::set_rectangle(bool rectangle) {
  return command(rectangle ? ":SOURce1:FUNCtion SQUare" : ":SOURce1:FUNCtion SINusoid");
}

// A connection that is made anew has a sine again: all of it goes over one.
Expected<void> ScpiGenerator::set_waveform(std::span<const double> samples_v, double rate_hz) {
  wants_waveform_ = true;
  has_waveform_ = false;
  if (connection_->lost()) {
    DYNCAL_TRY(reconnect());
  }
  DYNCAL_TRY(const auto loaded, load_waveform(identity_, samples_v, rate_hz));
  DYNCAL_TRY(set_amplitude_v(loaded.peak_v));
  for (const WaveformCommand& command : loaded.commands) {
    DYNCAL_TRY(connection_->command(command.text, command.block));
  }
  has_waveform_ = true;
  return {};
}

Expected<double> ScpiGenerator::query_bench_time(const std::string& text) {
  DYNCAL_TRY(const auto answer, query(text));
  double time_s = 0.0;
  const auto [end, status] = std::from_chars(answer.data(), answer.data() + answer.size(), time_s);
  if (status != std::errc()) {
    return fail(ErrorCode::malformed,
                "generator " + address_ + " answers " + text + " with '" + answer + "'");
  }
  return time_s;
}

void ScpiGenerator::call_while_waiting(const std::function<bool(Awaited)>& callback) {
  while_waiting_ = callback;
}

bool ScpiGenerator::go_on_waiting() {
  return !while_waiting_ || while_waiting_(Awaited::answer) || switches_off_;
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
    if (while_waiting_ && !while_waiting_(Awaited::bench_time)) {
      return now_s;
    }
  }
}

} // namespace dyncal::drivers::generator
