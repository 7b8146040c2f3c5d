// dyncal-dso BENCH.toml...: triggers time series sensors by an oscilloscope and publishes the
// records of both.
#include <memory>
#include <thread>
#include <vector>

#include "services/daemon/program/bench_program.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/programs/dso/triggered_bench.hpp"
#include "services/stream/source_service.hpp"
#include "services/stream/supervised.hpp"

namespace {

using namespace dyncal;
using dyncal::fail;

Expected<void> serve(const std::vector<BenchFile>& files, Daemon& daemon) {
  DYNCAL_TRY(daemon.join());
  const std::stop_token stop = daemon.stop();
  const auto service = SourceService::create(
      daemon.participant(),
      supervised(daemon.supervisor(), daemon.participant(), !daemon.network.security.empty()));
  std::vector<std::unique_ptr<dso::TriggeredBench>> benches;
  for (const BenchFile& file : files) {
    DYNCAL_TRY(auto bench, dso::TriggeredBench::create(daemon.participant(), *service, file));
    benches.push_back(std::move(bench));
  }
  service->start();
  daemon.supervisor().serving();
  {
    std::vector<std::jthread> threads; // joined at the end of this block
    for (const auto& bench : benches) {
      threads.emplace_back([&bench, stop] { bench->run(stop); });
    }
  }
  service->stop();
  return {};
}

} // namespace

int main(int argc, char** argv) {
  return run_bench_program(
      argc, argv,
      {.name = "dyncal-dso",
       .description =
           "Triggers time series sensors by an oscilloscope and publishes the records of "
           "both on DDS.",
       .serve = serve,
       .publishes_samples = true});
}
