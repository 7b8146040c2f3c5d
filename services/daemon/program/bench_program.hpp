// A daemon (daemon.hpp) that serves the bench files on its command line: reads them, joins its
// network options with theirs, and logs by a thread of its own. What it serves is all that such
// programs differ in.
//
// A library of its own beside the rest of this room: a program that reads no bench file
// (dyncal-analysis) links neither this nor the TOML parser.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/daemon/program/program.hpp"

namespace dyncal::inline daemon {

class Daemon;

// Adds the bench file's peers to those of the command line; what the command line leaves open is
// taken from the bench file.
void add_network_settings(const NetworkSettings& bench, NetworkOptions& options);

struct BenchProgram {
  std::string name;        // "dyncal-dau"
  std::string description; // one sentence, for --help
  // As DaemonProgram::serve, with the benches read.
  std::function<Expected<void>(const std::vector<BenchFile>& benches, Daemon& daemon)> serve;
  bool publishes_samples = false; // has --default-partition (services/bus/default_partition.hpp)
};

// The body of main(). Returns the exit status.
[[nodiscard]] int run_bench_program(int argc, char** argv, const BenchProgram& program);

} // namespace dyncal::inline daemon
