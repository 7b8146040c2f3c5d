// `dyncal demo`: a whole virtual bench, its services, DDS, analysis and report on this machine.
//
// Every instrument and service is a process of its own and talks as it does in a laboratory. All
// files go to one folder: bench file, ADC calibration, logs, result, figures, and the truth, which
// only the final comparison reads. With a response from a file the demo leaves out the frequencies
// at which the file does not know it. Belongs to one thread; all processes have ended when it
// returns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/programs/command/kept_run.hpp"

namespace dyncal::inline programs {

struct DemoCommand {
  std::string preset = "mpu9250-paper";
  std::string dds;         // empty: the first of the build, for all
  std::string speed = "8"; // times real time, or "max"
  std::uint64_t seed = 1;
  std::optional<int> domain; // chosen by itself
  std::filesystem::path folder = "demo";
  std::optional<std::filesystem::path> json;
  KeepOptions keep; // no run folder unless it names one
  std::optional<int> repetitions;
  std::optional<double> duration_s;
  bool trigger_phase_correction = true; // series time stamping
  double loss = 0.0;                    // of datagrams, 0..1
  double duplicates = 0.0;
  std::string can_interface = "vcan0"; // presets with CAN output
  std::string can_bus = "1M";
  std::optional<std::filesystem::path> response; // of the sensor, in place of the preset's
  std::vector<std::string> faults;               // of the virtual bench, each as its --fault
};

// Exit status: 0 when every result agrees with the bench's truth within four standard
// uncertainties.
[[nodiscard]] int run_demo(const DemoCommand& command, const std::stop_token& stop);

} // namespace dyncal::inline programs
