#include "services/program/bench_program.hpp"

#include <cstdlib>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "services/host_clocks/clock_messages.hpp"
#include "services/program/command_line.hpp"
#include "services/program/log.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

Expected<void> serve(const BenchProgram& program, const std::vector<std::string>& paths,
                     NetworkOptions network, Supervisor& supervisor, const std::stop_token& stop) {
  std::vector<BenchFile> benches;
  std::string names;
  for (const std::string& path : paths) {
    auto bench = read_bench_file(path);
    if (!bench) {
      return fail(bench.error());
    }
    add_network_settings(bench->network, network);
    names += (names.empty() ? "bench " : ", ") + bench->bench;
    benches.push_back(std::move(*bench));
  }
  supervisor.describe(names);
  return program.serve(benches, network, supervisor, stop);
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
  CLI::App app{program.description, program.name};
  app.set_version_flag("--version", build_description());
  std::vector<std::string> paths;
  NetworkOptions network;
  std::string metrics;
  app.add_option("BENCH.toml", paths, "bench files")->required();
  add_network_options(app, network);
  add_metrics_option(app, metrics);
  if (const auto status = read_command_line(app, argc, argv)) {
    return *status;
  }

  set_up_log(program.name, LogWriting::by_thread);
  const auto supervisor =
      Supervisor::create(this_program(program.name, software_version(), network.dds), metrics);
  if (!supervisor) {
    return report_error(supervisor.error());
  }
  const std::stop_token stop = stop_on_signals();
  const std::stop_callback stopping(stop, [&] { (*supervisor)->stopping(); });
  const auto served = serve(program, paths, network, **supervisor, stop);
  if (!served) {
    return report_error(served.error());
  }
  spdlog::info("stopped");
  finish_log();
  return EXIT_SUCCESS;
}

} // namespace dyncal::services
