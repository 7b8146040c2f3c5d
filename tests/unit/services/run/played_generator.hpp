// A generator whose bench time is the stepped clock, which notes what is set and fails where a test
// wants it.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/generator/generator.hpp"
#include "services/bus/memory/stepped_clock.hpp"
#include "services/run/generator_connection.hpp"

namespace dyncal::tests {

// What the instrument is in, and what it was told; outlives the generator.
struct PlayedInstrument {
  explicit PlayedInstrument(bus::SteppedClock& its_clock) : clock(its_clock) {}

  bus::SteppedClock& clock;
  std::vector<std::string> settings; // "10 Hz", "2 V", "on", "off"
  std::string frequency_hz;
  double amplitude_v = 0.0;
  bool on = false;
  bool connected = false;
  int connections = 0;
  bool confirmed = true; // what was set is in effect
  // A call that fails, by its name, from its n-th time on, so often.
  std::string failing_call;
  int failing_from = 1;
  int failing_times = std::numeric_limits<int>::max();
  int calls_of_failing = 0;
  std::string refused_hz; // a frequency that it does not take
  bool away = false;      // every call fails: it does not answer

  [[nodiscard]] double now_s() const {
    return std::chrono::duration<double>(clock.elapsed()).count();
  }
};

class PlayedGenerator : public drivers::generator::Generator {
public:
  explicit PlayedGenerator(PlayedInstrument& instrument) : instrument_(instrument) {
    instrument_.connected = true;
    ++instrument_.connections;
    instrument_.on = false;
  }
  ~PlayedGenerator() override {
    instrument_.on = false;
    instrument_.connected = false;
  }
  PlayedGenerator(const PlayedGenerator&) = delete;
  PlayedGenerator& operator=(const PlayedGenerator&) = delete;

  [[nodiscard]] const std::string& identity() const override { return identity_; }
  drivers::Expected<void> set_frequency(const std::string& decimal_hz) override {
    if (decimal_hz == instrument_.refused_hz) {
      return fail(drivers::ErrorCode::refused, decimal_hz + " Hz was refused");
    }
    return called("set_frequency").map([&] {
      instrument_.frequency_hz = decimal_hz;
      instrument_.settings.push_back(decimal_hz + " Hz");
    });
  }
  drivers::Expected<void> set_amplitude_v(double amplitude_v) override {
    return called("set_amplitude_v").map([&] {
      instrument_.amplitude_v = amplitude_v;
      std::string text = std::to_string(amplitude_v);
      text.erase(text.find_last_not_of('0') + 1);
      instrument_.settings.push_back(text + (text.back() == '.' ? "0 V" : " V"));
    });
  }
  drivers::Expected<void> set_output(bool on) override {
    return called(on ? "set_output(true)" : "set_output(false)").map([&] {
      instrument_.on = on;
      instrument_.settings.emplace_back(on ? "on" : "off");
    });
  }
  drivers::Expected<bool> wait_for_effect(std::chrono::milliseconds limit) override {
    return called("wait_for_effect").map([&] {
      if (!instrument_.confirmed) {
        instrument_.clock.advance(limit);
      }
      return instrument_.confirmed;
    });
  }
  drivers::Expected<double> clock_now_s() override {
    return called("clock_now_s").map([&] { return instrument_.now_s(); });
  }
  drivers::Expected<double> wait_until_s(double time_s, std::stop_token stop) override {
    return called("wait_until_s").map([&] {
      while (instrument_.now_s() < time_s && !stop.stop_requested()) {
        const std::chrono::duration<double> left(time_s - instrument_.now_s());
        instrument_.clock.advance(std::clamp(
            std::chrono::ceil<std::chrono::nanoseconds>(left), std::chrono::nanoseconds(1),
            std::chrono::nanoseconds(std::chrono::milliseconds(50))));
      }
      return instrument_.now_s();
    });
  }

private:
  drivers::Expected<void> called(const std::string& call) {
    if (instrument_.away) {
      instrument_.clock.advance(std::chrono::seconds(1)); // waits for an answer
      return fail(drivers::ErrorCode::timeout, "the instrument does not answer");
    }
    if (call == instrument_.failing_call &&
        ++instrument_.calls_of_failing >= instrument_.failing_from &&
        instrument_.calls_of_failing - instrument_.failing_from < instrument_.failing_times) {
      return fail(drivers::ErrorCode::refused, call + " was refused");
    }
    return {};
  }

  PlayedInstrument& instrument_;
  std::string identity_ = "played";
};

inline run::ConnectGenerator connect_to(PlayedInstrument& instrument) {
  return [&instrument](const bench::GeneratorSettings&, const run::AskOperator&) {
    run::GeneratorConnection connection;
    connection.generator = std::make_unique<PlayedGenerator>(instrument);
    return base::Expected<run::GeneratorConnection>(std::move(connection));
  };
}

} // namespace dyncal::tests
