#include "services/program/bench_program.hpp"

#include <cstdlib>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "services/program/log.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

Expected<void> serve(const BenchProgram& program, const std::vector<std::string>& paths,
                     NetworkOptions network, const std::stop_token& stop) {
  std::vector<BenchFile> benches;
  for (const std::string& path : paths) {
    auto bench = read_bench_file(path);
    if (!bench) {
      return fail(bench.error());
    }
    add_network_settings(bench->network, network);
    benches.push_back(std::move(*bench));
  }
  return program.serve(benches, network, stop);
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
  app.add_option("BENCH", paths, "bench files (TOML)")->required();
  add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);

  set_up_log(program.name, LogWriting::by_thread);
  const auto served = serve(program, paths, network, stop_on_signals());
  if (!served) {
    return report_error(served.error());
  }
  spdlog::info("stopped");
  finish_log();
  return EXIT_SUCCESS;
}

} // namespace dyncal::services
