// dyncal-can BENCH.toml...: publishes the sensors on CAN interfaces of this host.
#include <cstdlib>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "services/bench/bench_file.hpp"
#include "services/can/can_source.hpp"
#include "services/program/program.hpp"
#include "services/source/run_sources.hpp"
#include "services/version.hpp"

namespace {

using namespace dyncal::services;
using dyncal::fail;

using Sources = std::vector<RunnableSource<can::CanSource>>;

Expected<Sources> prepare(const std::vector<std::string>& files, NetworkOptions& network) {
  Sources sources;
  for (const std::string& file : files) {
    const auto bench = read_bench_file(file);
    if (!bench) {
      return fail(bench.error());
    }
    add_network_settings(bench->network, network);
    for (const SourceSettings& settings : bench->sources) {
      if (settings.driver != SourceDriver::can) {
        continue; // others publish it
      }
      auto source = can::CanSource::prepare(settings);
      if (!source) {
        return fail(source.error().code,
                    fmt::format("{}: {}", settings.where, source.error().message));
      }
      for (const std::string& warning : source->warnings()) {
        spdlog::warn("{}", warning);
      }
      SourceOptions options;
      options.bench = bench->bench;
      options.source = settings.name;
      options.kind = SourceKind::can;
      sources.push_back({std::move(*source), std::move(options)});
    }
  }
  if (sources.empty()) {
    return fail(ErrorCode::bad_argument, "no source with driver \"can\" in the bench files given");
  }
  return sources;
}

Expected<void> run(const std::vector<std::string>& files, NetworkOptions network,
                   const std::stop_token& stop) {
  auto sources = prepare(files, network);
  if (!sources) {
    return fail(sources.error());
  }
  auto participant = join_network(network, "dyncal-can");
  if (!participant) {
    return fail(participant.error());
  }
  return run_sources(*participant, *sources, stop);
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app{"Publishes the sources of bench files whose driver is \"can\": sensors on CAN and "
               "CAN FD interfaces of this host.",
               "dyncal-can"};
  app.set_version_flag("--version", build_description());
  std::vector<std::string> files;
  NetworkOptions network;
  app.add_option("BENCH", files, "bench files (TOML)")->required();
  add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);

  set_up_log("dyncal-can");
  const std::stop_token stop = stop_on_signals();
  if (const auto done = run(files, network, stop); !done) {
    return report_error(done.error());
  }
  return EXIT_SUCCESS;
}
