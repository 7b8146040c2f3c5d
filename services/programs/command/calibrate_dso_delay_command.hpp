// `dyncal calibrate dso-delay`: the delay of an oscilloscope's trigger output, in the set-up of
// paper section 2.4: the sync line on one input, the trigger output fed back to another
// (analysis/instrument/trigger_delay.hpp).
//
// Takes shots, prints delay, uncertainty and histogram, and writes them as JSON: the file that
// [corrections] dso_delay = { file = ... } of a bench file names
// (services/bench/file/dso_delay_file.hpp). With a generator's address the generator is set and its
// output switched on and off; otherwise the operator does that. A shot that fails is repeated, up
// to as many failures as shots. Belongs to one thread.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>

namespace dyncal::inline programs {

struct CalibrateDsoDelayCommand {
  std::string oscilloscope;     // address, see drivers/link/scpi_transport.hpp
  std::string family;           // of the oscilloscope; empty: by its identity
  std::string generator;        // address; empty: set by hand
  std::string by = "rectangle"; // or "sine"
  std::string frequency_hz = "1000";
  double amplitude_v = 0.05; // of the generator, zero to peak
  int sync_input = 1;
  int output_input = 2;
  double sync_range_v = 20.0;
  double output_range_v = 5.0;
  int shots = 50;
  std::filesystem::path output = "dso-delay.json";
};

[[nodiscard]] int run_calibrate_dso_delay(const CalibrateDsoDelayCommand& command,
                                          const std::stop_token& stop);

} // namespace dyncal::inline programs
