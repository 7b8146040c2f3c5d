// dyncal-dso BENCH.toml...: triggers time series sensors by an oscilloscope and publishes the
// records of both.
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "services/bench/bench_file.hpp"
#include "services/dso/bench_service.hpp"
#include "services/program/program.hpp"
#include "services/version.hpp"

namespace {

using namespace dyncal::services;

Expected<void> run(const std::vector<std::string>& paths, NetworkOptions options,
                   const std::stop_token& stop) {
  std::vector<BenchFile> benches;
  for (const std::string& path : paths) {
    auto bench = read_bench_file(path);
    if (!bench) {
      return fail(bench.error());
    }
    add_network_settings(bench->network, options);
    benches.push_back(std::move(*bench));
  }
  auto participant = join_network(options, "dyncal-dso");
  if (!participant) {
    return fail(participant.error());
  }
  std::vector<std::unique_ptr<dso::BenchService>> services;
  for (const BenchFile& bench : benches) {
    auto service = dso::BenchService::create(*participant, bench);
    if (!service) {
      return fail(service.error());
    }
    services.push_back(std::move(*service));
  }
  {
    std::vector<std::jthread> threads; // joined at the end of this block
    for (const auto& service : services) {
      threads.emplace_back([&service, stop] { service->run(stop); });
    }
  }
  spdlog::info("stopped");
  return {};
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Triggers time series sensors by an oscilloscope and publishes the records of both on DDS.",
      "dyncal-dso"};
  app.set_version_flag("--version", build_description());
  std::vector<std::string> benches;
  NetworkOptions network;
  app.add_option("BENCH", benches, "bench files (TOML)")->required();
  add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);
  set_up_log("dyncal-dso");
  const auto result = run(benches, network, stop_on_signals());
  return result ? 0 : report_error(result.error());
}
