// The output of a generator over SCPI, for anyone who guards it beside the program that drives it:
// asks whether and with what it is on, and switches it off. Nothing else of the instrument is
// changed, since a person may have set it.
//
//   :OUTPut1?, :SOURce1:FREQuency?, :SOURce1:VOLTage?     (peak to peak)
//   :OUTPut1 OFF, then :OUTPut1?
//
// Each call connects, asks and closes: an instrument that takes one connection is free in between.
// OFF is the first that is sent, before anything is asked, so that it reaches an instrument that
// answers late or not at all. Calls take at most a few seconds. Any thread.
//
// Fails: as ScpiConnection does; refused where the output answers that it is still on.
#pragma once

#include <optional>
#include <string>

#include "drivers/error.hpp"

namespace dyncal::drivers::generator {

struct OutputSettings {
  double frequency_hz = 0.0;
  std::optional<double> voltage_vpp; // nothing: not known

  friend bool operator==(const OutputSettings&, const OutputSettings&) = default;
};

struct OutputReading {
  std::optional<bool> is_on;              // nothing: its answer is neither
  std::optional<OutputSettings> settings; // nothing: its answer is no number
};

[[nodiscard]] Expected<OutputReading> read_output(const std::string& address);
[[nodiscard]] Expected<void> switch_output_off(const std::string& address);

// Of an output that answers ON after it was switched off.
[[nodiscard]] Error still_on(const std::string& address);

// The answer to :OUTPut1?
[[nodiscard]] std::optional<bool> parse_output_state(const std::string& answer);

} // namespace dyncal::drivers::generator
