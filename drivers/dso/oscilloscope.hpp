// An oscilloscope that triggers on sync, starts a time series sensor by its trigger output, and
// records what its inputs see.
//
// acquire() takes one single shot: arm, wait for the trigger, read every input. Times are in
// seconds relative to the trigger point of the instrument, all inputs of a shot on one axis.
//
// After anything that leaves it open which answer belongs to which question (time-out, half an
// answer, garbage, lost connection) the connection is closed, and the next call connects,
// identifies and sets up again: an instrument that was switched off comes back by itself. The shot
// that failed is not repeated here.
//
// Fails: refused (the instrument's own error, or an instrument that is in no table), timeout (also:
// no trigger came; the instrument is then told to stop and the connection stays), malformed,
// disconnected, not_found, invalid_setting. One thread; StopSignal ends waits from another.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/dso/scope_commands.hpp"
#include "drivers/dso/waveform.hpp"
#include "drivers/error.hpp"
#include "drivers/link/scpi_connection.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers::dso {

struct InputSettings {
  std::string name;      // of the channel: "sync", "trigger"
  int input = 1;         // at the instrument
  double range_v = 20.0; // peak to peak, that the trace must hold
  double centre_v = 0.0; // of that range
};

struct OscilloscopeSettings {
  std::string address; // see drivers/link/scpi_transport.hpp
  std::string family;  // of the table; empty: by *IDN?
  std::vector<InputSettings> inputs;
  std::size_t trigger_input = 0; // place in `inputs`
  double trigger_level_v = 0.0;
  std::chrono::milliseconds answer_limit{3000};
};

struct Acquisition {
  double before_trigger_s = 0.0; // the trace covers at least [-before, after]
  double after_trigger_s = 0.0;
  std::size_t points = 10'000; // memory depth; the instrument may take the next one it has

  friend bool operator==(const Acquisition&, const Acquisition&) = default;
};

struct Trace {
  std::string name;
  std::vector<double> volts;
  double resolution_v = 0.0; // one step of the converter
};

struct Shot {
  double first_sample_s = 0.0; // relative to the trigger point
  double interval_s = 0.0;
  std::vector<Trace> traces; // in the order of the inputs, all of the same length
  // Host clock when the instrument first reported the trigger: late by up to one answer.
  std::int64_t triggered_utc_ns = 0;
};

class Oscilloscope {
public:
  // `stop` outlives the oscilloscope. Nothing is connected yet.
  Oscilloscope(OscilloscopeSettings settings, const StopSignal& stop);

  // Connects when necessary and applies the settings. Repeated calls with the same acquisition cost
  // nothing.
  [[nodiscard]] Expected<void> prepare(const Acquisition& acquisition);

  // One shot of the prepared acquisition; the trigger may take `trigger_limit`.
  [[nodiscard]] Expected<Shot> acquire(std::chrono::milliseconds trigger_limit);

  // As the instrument reports it; empty before the first connection.
  [[nodiscard]] const std::string& identity() const { return identity_; }
  [[nodiscard]] const std::string& address() const { return settings_.address; }
  [[nodiscard]] std::uint64_t connections() const { return connections_; }

private:
  Expected<void> connect();
  Expected<void> apply(const Acquisition& acquisition);
  Expected<std::int64_t> wait_for_trigger(std::chrono::milliseconds limit);
  Expected<Shot> read_shot();
  Expected<Trace> read_trace(const InputSettings& input, Preamble& preamble);
  Expected<Preamble> read_preamble(const InputSettings& input);
  [[nodiscard]] std::string message(const std::string& text) const {
    return "oscilloscope " + settings_.address + ": " + text;
  }
  void give_up_connection();

  const OscilloscopeSettings settings_;
  const StopSignal& stop_;
  std::optional<ScpiConnection> connection_;
  const ScopeCommands* commands_ = nullptr;
  std::optional<Acquisition> prepared_;
  std::optional<Acquisition> wanted_;
  std::string identity_;
  std::uint64_t connections_ = 0;
};

// The smallest 1, 2 or 5 times a power of ten that is not below `value`: the steps that
// oscilloscopes have. REQUIRES: value > 0.
[[nodiscard]] double next_scope_step(double value);

} // namespace dyncal::drivers::dso
