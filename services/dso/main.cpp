// dyncal-dso BENCH.toml...: triggers time series sensors by an oscilloscope and publishes the
// records of both.
#include <memory>
#include <thread>
#include <vector>

#include "services/dso/triggered_bench.hpp"
#include "services/host_clocks/clock_responder.hpp"
#include "services/program/bench_program.hpp"
#include "services/program/watched_network.hpp"
#include "services/source/source_service.hpp"
#include "services/source/supervised.hpp"

namespace {

using namespace dyncal::services;
using dyncal::fail;

Expected<void> serve(const std::vector<BenchFile>& files, const NetworkOptions& network,
                     Supervisor& supervisor, const std::stop_token& asked) {
  auto joined = WatchedNetwork::join(network, "dyncal-dso", asked);
  if (!joined) {
    return fail(joined.error());
  }
  dyncal::bus::Participant& participant = (*joined)->participant;
  const std::stop_token stop = (*joined)->stop();
  const auto service = SourceService::create(participant, supervised(supervisor, participant));
  std::vector<std::unique_ptr<dso::TriggeredBench>> benches;
  for (const BenchFile& file : files) {
    auto bench = dso::TriggeredBench::create(participant, *service, file);
    if (!bench) {
      return fail(bench.error());
    }
    benches.push_back(std::move(*bench));
  }
  const auto clock = ClockResponder::start(participant, supervisor.identity());
  if (!clock) {
    return fail(clock.error());
  }
  service->start();
  supervisor.serving();
  {
    std::vector<std::jthread> threads; // joined at the end of this block
    for (const auto& bench : benches) {
      threads.emplace_back([&bench, stop] { bench->run(stop); });
    }
  }
  service->stop();
  return (*joined)->outcome({});
}

} // namespace

int main(int argc, char** argv) {
  return run_bench_program(
      argc, argv,
      {.name = "dyncal-dso",
       .description =
           "Triggers time series sensors by an oscilloscope and publishes the records of "
           "both on DDS.",
       .serve = serve});
}
