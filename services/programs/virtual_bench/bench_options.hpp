// The command line of dyncal-virtual-bench, read and checked. One thread, at start.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "drivers/virtual_bench/can/can_sensor.hpp"
#include "drivers/virtual_bench/model/recording.hpp"
#include "drivers/virtual_bench/model/virtual_bench.hpp"
#include "drivers/virtual_bench/wire/bench_server.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline programs::virtual_bench {

struct BenchOptions {
  drivers::virtual_bench::BenchSettings bench;
  drivers::virtual_bench::ServerSettings server;
  drivers::virtual_bench::Programme
      programme;                    // its frequencies are those of the truth and ADC files as well
  std::filesystem::path truth_file; // empty: not wanted
  std::filesystem::path adc_file;
  std::filesystem::path acs_table; // of an ACS that evaluates itself; empty: it does not
  std::filesystem::path ports_file;
  std::filesystem::path record_folder;           // set: files instead of sockets
  std::string can_interface;                     // of a sensor with CAN output; empty: none
  drivers::virtual_bench::CanSensorSettings can; // its preset and seed are those of the bench
  std::filesystem::path dbc_file;
  bool exit_with_parent = false;
};

// Nothing when the command line asked for help only, which has been printed then. Fails
// (bad_argument).
[[nodiscard]] Expected<std::optional<BenchOptions>> parse_command_line(int argc, char** argv);

} // namespace dyncal::inline programs::virtual_bench
