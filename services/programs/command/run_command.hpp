// `dyncal run BENCH.toml`: conducts a run with progress on standard error, the result table on
// standard output, its folder on the disk, JSON and figures on request. Exit status 0 only when
// every planned step has a valid result. Belongs to one thread.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "services/daemon/program/program.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/views/report/run_figures.hpp"

namespace dyncal::inline programs {

struct RunOptions {
  std::filesystem::path bench_file;
  std::string run;                             // its name; empty: the time
  std::optional<std::filesystem::path> output; // the result as JSON
  FigureFiles figures;                         // folder
  bool wait = false;                           // for the end of another run of the bench
  std::string without_check; // why a check that the bench demands is left out; empty: it is not
  std::string conducted_by;  // the name of the operator; empty: not stated
  std::string comment;
  std::string sensor; // its serial number in the library; empty: that of the bench file
  std::string resume; // the run to go on with, the newest of that name; empty: a new one
  KeepOptions keep;
  NetworkOptions network;
};

// Does the run and prints; the outcome is for callers that look further into it.
[[nodiscard]] Expected<RunOutcome> conduct_run(const RunOptions& command,
                                               const std::stop_token& stop);

} // namespace dyncal::inline programs
