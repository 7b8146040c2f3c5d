#include "drivers/generator/scpi_generator.hpp"

#include <charconv>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace dyncal::drivers::generator {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds connect_limit{5000};
constexpr milliseconds answer_limit{2000};
constexpr std::size_t longest_answer = 4096;

// The shortest decimal text of a number; never an exponent, which some instruments do not read.
std::string decimal(double value) {
  char text[400];
  const auto [end, status] = std::to_chars(text, text + sizeof(text), value, std::chars_format::fixed);
  return status == std::errc() ? std::string(text, end) : std::string("0");
}

} // namespace

Expected<std::unique_ptr<ScpiGenerator>> ScpiGenerator::connect(const std::string& address) {
  const auto parsed = parse_address(address);
  if (!parsed) {
    return tl::unexpected(Error{parsed.error().code, "generator: " + parsed.error().message});
  }
  std::unique_ptr<ScpiGenerator> generator(new ScpiGenerator());
  generator->address_ = address;
  auto connection = TcpConnection::connect(*parsed, connect_limit, generator->never_);
  if (!connection) {
    return tl::unexpected(Error{connection.error().code, "generator " + connection.error().message});
  }
  generator->connection_ = std::make_unique<TcpConnection>(std::move(*connection));
  if (auto ready = generator->set_up(); !ready) {
    generator->connection_.reset(); // nothing to switch off
    return tl::unexpected(ready.error());
  }
  return generator;
}

ScpiGenerator::~ScpiGenerator() {
  if (connection_) {
    // Nothing can be done about a failure here: whoever needs to know has called set_output(false) before.
    static_cast<void>(command(":OUTPut1 OFF"));
  }
}

Expected<void> ScpiGenerator::set_up() {
  auto identity = query("*IDN?");
  if (!identity) {
    return tl::unexpected(identity.error());
  }
  identity_ = *identity;
  for (const char* setting : {":OUTPut1 OFF", ":OUTPut1:LOAD INFinity", ":SOURce1:FUNCtion SINusoid", ":SOURce1:VOLTage:UNIT VPP"}) {
    if (auto done = command(setting); !done) {
      return done;
    }
  }
  host_origin_ = std::chrono::steady_clock::now();
  // Only a virtual bench has a time of its own; an instrument that does not know the query says nothing or reports an error.
  has_bench_clock_ = identity_.find("dyncal virtual bench") != std::string::npos;
  return {};
}

Expected<std::string> ScpiGenerator::query(const std::string& text) {
  auto sent = connection_->send_all(text + "\n", answer_limit);
  if (!sent) {
    return tl::unexpected(Error{sent.error().code, "generator " + sent.error().message + " (" + text + ")"});
  }
  auto answer = connection_->read_line(longest_answer, answer_limit);
  if (!answer) {
    return tl::unexpected(Error{answer.error().code, "generator " + answer.error().message + " (" + text + ")"});
  }
  return *answer;
}

Expected<void> ScpiGenerator::command(const std::string& text) {
  if (auto sent = connection_->send_all(text + "\n", answer_limit); !sent) {
    return tl::unexpected(Error{sent.error().code, "generator " + sent.error().message + " (" + text + ")"});
  }
  const auto answer = query(":SYSTem:ERRor?");
  if (!answer) {
    return tl::unexpected(answer.error());
  }
  int code = 0;
  const char* begin = answer->data() + (answer->starts_with('+') ? 1 : 0);
  const auto [end, status] = std::from_chars(begin, answer->data() + answer->size(), code);
  if (status == std::errc() && code == 0) {
    return {};
  }
  return tl::unexpected(Error{ErrorCode::refused, "generator " + address_ + " refuses " + text + ": " + *answer});
}

Expected<void> ScpiGenerator::set_frequency(const std::string& decimal_hz) {
  return command(":SOURce1:FREQuency " + decimal_hz);
}

Expected<void> ScpiGenerator::set_amplitude_v(double amplitude_v) {
  if (!(amplitude_v >= 0.0 && amplitude_v <= 1000.0)) {
    return tl::unexpected(Error{ErrorCode::invalid_setting, "generator: an amplitude of " + decimal(amplitude_v) + " V cannot be set"});
  }
  return command(":SOURce1:VOLTage " + decimal(2.0 * amplitude_v));
}

Expected<void> ScpiGenerator::set_output(bool on) {
  return command(on ? ":OUTPut1 ON" : ":OUTPut1 OFF");
}

Expected<double> ScpiGenerator::query_bench_time(const std::string& text) {
  const auto answer = query(text);
  if (!answer) {
    return tl::unexpected(answer.error());
  }
  double time_s = 0.0;
  const auto [end, status] = std::from_chars(answer->data(), answer->data() + answer->size(), time_s);
  if (status != std::errc()) {
    return tl::unexpected(Error{ErrorCode::malformed, "generator " + address_ + " answers " + text + " with '" + *answer + "'"});
  }
  return time_s;
}

Expected<double> ScpiGenerator::clock_now_s() {
  if (has_bench_clock_) {
    return query_bench_time(":BENCh:TIME?");
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - host_origin_).count();
}

Expected<double> ScpiGenerator::wait_until_s(double time_s, std::stop_token stop) {
  for (;;) {
    // The virtual bench answers :BENCh:WAIT? when the time has come, at the latest after half a second of the host.
    auto now_s = has_bench_clock_ ? query_bench_time(":BENCh:WAIT? " + decimal(time_s)) : clock_now_s();
    if (!now_s || *now_s >= time_s || stop.stop_requested()) {
      return now_s;
    }
    if (!has_bench_clock_) {
      std::mutex mutex;
      std::unique_lock lock(mutex);
      std::condition_variable_any stopped;
      stopped.wait_for(lock, stop, std::chrono::duration<double>(time_s - *now_s), [] { return false; });
    }
  }
}

} // namespace dyncal::drivers::generator
