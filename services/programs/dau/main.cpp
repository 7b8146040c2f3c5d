// dyncal-dau BENCH.toml...: receives the SmartUp Units of one or more benches and publishes their
// sensors.
#include <memory>
#include <vector>

#include <spdlog/spdlog.h>

#include "drivers/smartup/receiver.hpp"
#include "services/daemon/program/bench_program.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/instruments/listening_plan.hpp"
#include "services/programs/dau/endpoint_watch.hpp"
#include "services/stream/source_service.hpp"
#include "services/stream/supervised.hpp"

namespace dyncal::inline programs::dau {
namespace {

constexpr int wanted_receive_buffer = 4 << 20; // bytes; about half a second of sixteen units

// One socket an address, watched, with a publisher for each sensor.
struct Reception {
  std::vector<std::unique_ptr<EndpointWatch>> watches;
  std::vector<std::shared_ptr<SourcePublisher>> publishers;
  std::unique_ptr<drivers::smartup::Receiver> receiver;
};

Expected<Reception> open_reception(std::vector<PlannedEndpoint> plan, SourceService& service) {
  Reception reception;
  std::vector<drivers::smartup::Receiver::Endpoint> endpoints;
  for (PlannedEndpoint& planned : plan) {
    auto& watch = reception.watches.emplace_back(std::make_unique<EndpointWatch>(planned.listen));
    auto& endpoint = endpoints.emplace_back();
    endpoint.listen = planned.listen;
    endpoint.observer = watch.get();
    for (PlannedSource& source : planned.sources) {
      DYNCAL_TRY(auto publisher, service.add({.bench = source.bench,
                                              .source = source.source,
                                              .kind = SourceKind::dau,
                                              .identity = source.identity,
                                              .origin = source.origin}));
      endpoint.wanted.push_back({source.settings, publisher.get()});
      reception.publishers.push_back(publisher);
      watch->add(std::move(source), std::move(publisher));
    }
  }
  auto receiver = drivers::smartup::Receiver::create(std::move(endpoints));
  if (!receiver) {
    return fail(ErrorCode::device, receiver.error().message);
  }
  reception.receiver = std::move(*receiver);
  return reception;
}

void report_sockets(const drivers::smartup::Receiver& receiver,
                    const std::vector<PlannedEndpoint>& plan) {
  for (std::size_t i = 0; i < plan.size(); ++i) {
    spdlog::info("listening at UDP {} for {} sensor{}", plan[i].listen, plan[i].sources.size(),
                 plan[i].sources.size() == 1 ? "" : "s");
    const int bytes = receiver.receive_buffer_bytes(i);
    if (bytes < wanted_receive_buffer) {
      spdlog::warn("the system allows a receive buffer of {} bytes only: set net.core.rmem_max to "
                   "{} or more",
                   bytes, wanted_receive_buffer);
    }
  }
}

Expected<void> serve(const std::vector<BenchFile>& benches, Daemon& daemon) {
  DYNCAL_TRY(const auto plan, plan_listening(benches));
  DYNCAL_TRY(daemon.join());
  const auto service = SourceService::create(
      daemon.participant(),
      supervised(daemon.supervisor(), daemon.participant(), !daemon.network.security.empty()));
  DYNCAL_TRY(auto reception, open_reception(plan, *service));
  report_sockets(*reception.receiver, plan);
  service->start();
  reception.receiver->start();
  daemon.supervisor().serving();
  wait_for_stop(daemon.stop());
  reception.receiver->stop();
  service->stop();
  return {};
}

} // namespace
} // namespace dyncal::inline programs::dau

int main(int argc, char** argv) {
  using namespace dyncal;
  return run_bench_program(
      argc, argv,
      {.name = "dyncal-dau",
       .description = "Receives SmartUp Units and publishes the samples of their sensors on DDS.",
       .serve = dau::serve,
       .publishes_samples = true});
}
