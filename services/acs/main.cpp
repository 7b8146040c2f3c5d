// dyncal-acs: publishes analogue calibration systems (their TCP streams) and recorded series of any
// source.
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "services/acs/played_source.hpp"
#include "services/bench/bench_file.hpp"
#include "services/program/program.hpp"
#include "services/source/run_sources.hpp"
#include "services/version.hpp"

namespace {

using namespace dyncal::services;
using dyncal::fail;
using dyncal::services::acs::PlayedSource;

constexpr std::chrono::seconds silent_after{2};

using Sources = std::vector<RunnableSource<PlayedSource>>;

Expected<Sources> prepare(const std::vector<std::string>& files, NetworkOptions& network,
                          const std::stop_token& stop) {
  Sources sources;
  for (const std::string& file : files) {
    const auto bench = read_bench_file(file);
    if (!bench) {
      return fail(bench.error());
    }
    add_network_settings(bench->network, network);
    for (const SourceSettings& settings : bench->sources) {
      if (settings.driver != SourceDriver::socket && settings.driver != SourceDriver::file) {
        continue; // dyncal-dau, dyncal-can or dyncal-dso publishes it
      }
      auto source = PlayedSource::prepare(settings, stop);
      if (!source) {
        return fail(source.error().code, fmt::format("{}: {}", file, source.error().message));
      }
      SourceOptions options;
      options.bench = bench->bench;
      options.source = settings.name;
      options.kind = acs::kind_of(bench->method, settings.name);
      options.silent_after =
          settings.driver == SourceDriver::file ? std::chrono::seconds(0) : silent_after;
      sources.push_back({std::move(*source), std::move(options)});
    }
  }
  if (sources.empty()) {
    return fail(ErrorCode::bad_argument,
                "no source with driver \"socket\" or \"file\" in the bench files given");
  }
  return sources;
}

Expected<void> run(const std::vector<std::string>& files, NetworkOptions network,
                   const std::stop_token& stop) {
  auto sources = prepare(files, network, stop);
  if (!sources) {
    return fail(sources.error());
  }
  auto participant = join_network(network, "dyncal-acs");
  if (!participant) {
    return fail(participant.error());
  }
  return run_sources(*participant, *sources, stop);
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app{"Publishes the sources of bench files whose driver is \"socket\" (an analogue "
               "calibration system's TCP stream) or \"file\" "
               "(a recorded series)."};
  app.set_version_flag("--version", build_description());
  std::vector<std::string> files;
  NetworkOptions network;
  app.add_option("bench", files, "bench files")->required();
  add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);

  set_up_log("dyncal-acs");
  const std::stop_token stop = stop_on_signals();
  if (const auto done = run(files, network, stop); !done) {
    return report_error(done.error());
  }
  return EXIT_SUCCESS;
}
