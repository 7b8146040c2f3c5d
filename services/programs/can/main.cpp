// dyncal-can BENCH.toml...: publishes the sensors on CAN interfaces of this host.
#include <string>
#include <vector>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/daemon/program/bench_program.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/programs/can/can_source.hpp"
#include "services/stream/run_sources.hpp"

namespace {

using namespace dyncal;
using dyncal::fail;

using Sources = std::vector<RunnableSource<can::CanSource>>;

Expected<Sources> prepare(const std::vector<BenchFile>& benches) {
  Sources sources;
  for (const BenchFile& bench : benches) {
    for (const SourceSettings& settings : bench.sources) {
      if (!settings.is<CanSourceSettings>()) {
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
      sources.push_back({std::move(*source), can::options_of(bench.bench, settings)});
    }
  }
  if (sources.empty()) {
    return fail(ErrorCode::bad_argument, "no source with driver \"can\" in the bench files given");
  }
  return sources;
}

Expected<void> serve(const std::vector<BenchFile>& benches, Daemon& daemon) {
  DYNCAL_TRY(auto sources, prepare(benches));
  DYNCAL_TRY(daemon.join());
  return run_sources(daemon, sources);
}

} // namespace

int main(int argc, char** argv) {
  return run_bench_program(
      argc, argv,
      {.name = "dyncal-can",
       .description =
           "Publishes the sources of bench files whose driver is \"can\": sensors on CAN "
           "and CAN FD interfaces of this host.",
       .serve = serve,
       .publishes_samples = true});
}
