#include "services/daemon/program/bench_program.hpp"

#include <CLI/CLI.hpp>

#include "services/bus/default_partition.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"

namespace dyncal::inline daemon {
namespace {

Expected<std::vector<BenchFile>> read_benches(const std::vector<std::string>& paths,
                                              Daemon& daemon) {
  std::vector<BenchFile> benches;
  std::string names;
  for (const std::string& path : paths) {
    DYNCAL_TRY(auto bench, read_bench_file(path));
    add_network_settings(bench.network, daemon.network);
    names += (names.empty() ? "bench " : ", ") + bench.bench;
    benches.push_back(std::move(bench));
  }
  daemon.supervisor().describe(names);
  return benches;
}

Expected<void> open_default_partition(bool wanted, const Daemon& daemon) {
  if (wanted && !daemon.network.security.empty()) {
    return fail(ErrorCode::bad_argument,
                "--default-partition: a secured laboratory publishes nothing there; leave the "
                "option out, or --security");
  }
  bus::publish_samples_in_default_partition(wanted);
  return {};
}

} // namespace

void add_network_settings(const NetworkSettings& bench, NetworkOptions& options) {
  options.peers.insert(options.peers.end(), bench.peers.begin(), bench.peers.end());
  options.no_multicast = options.no_multicast || !bench.multicast;
  if (options.interface_name.empty()) {
    options.interface_name = bench.interface_name;
  }
}

int run_bench_program(int argc, char** argv, const BenchProgram& program) {
  std::vector<std::string> paths;
  bool default_partition = false;
  return run_daemon(
      argc, argv,
      {.name = program.name,
       .description = program.description,
       .log = LogWriting::by_thread,
       .add_options =
           [&](CLI::App& app) {
             app.add_option("BENCH.toml", paths, "bench files")->required();
             if (program.publishes_samples) {
               app.add_flag("--default-partition", default_partition,
                            "publish samples in DDS' default partition, too, for tools that have "
                            "no partitions");
             }
           },
       .serve = [&](Daemon& daemon) -> Expected<void> {
         DYNCAL_TRY(open_default_partition(default_partition, daemon));
         DYNCAL_TRY(const auto benches, read_benches(paths, daemon));
         return program.serve(benches, daemon);
       }});
}

} // namespace dyncal::inline daemon
