// `dyncal run BENCH.toml`: conducts a run with progress on standard error, the result table on
// standard output, its folder on the disk, JSON and figures on request. Exit status 0 only when
// every planned step has a valid result. Belongs to one thread.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/daemon/program/program.hpp"
#include "services/programs/command/kept_run.hpp"
#include "services/run/run_controller.hpp"
#include "services/views/report/run_figures.hpp"

namespace dyncal::inline programs {

struct RunCommand {
  std::filesystem::path bench_file;
  std::string run; // its name; empty: the time
  std::optional<std::filesystem::path> json;
  FigureFiles figures; // folder
  bool wait = false;   // for the end of another run of the bench
  std::string resume;  // the run to go on with, the newest of that name; empty: a new one
  KeepOptions keep;
  NetworkOptions network;
};

// Does the run and prints; the outcome is for callers that look further into it.
[[nodiscard]] Expected<RunOutcome> conduct_run(const RunCommand& command,
                                               const std::stop_token& stop);

// "20261121T101530.125Z": sorts by time, fits a key, and differs between two runs that a script
// starts in the same second.
[[nodiscard]] std::string run_from_time();

// The points of the ADC calibration that the bench file names; none when it names none.
[[nodiscard]] Expected<std::vector<analysis::AdcCalibrationPoint>>
read_adc_calibration(const BenchFile& bench);

// The exit status and, unless 0, one line on standard error.
[[nodiscard]] int conclude(const RunOutcome& outcome);

} // namespace dyncal::inline programs
