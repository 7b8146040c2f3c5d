// dyncal-dau BENCH.toml...: receives the SmartUp Units of one or more benches and publishes their
// sensors.
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "drivers/smartup/receiver.hpp"
#include "services/bench/bench_file.hpp"
#include "services/dau/endpoint_sink.hpp"
#include "services/dau/event_lines.hpp"
#include "services/dau/listening_plan.hpp"
#include "services/program/program.hpp"
#include "services/source/source_service.hpp"
#include "services/version.hpp"

namespace dyncal::services::dau {
namespace {

constexpr auto log_interval = std::chrono::milliseconds(200);
constexpr int wanted_receive_buffer = 4 << 20; // bytes; about half a second of sixteen units

void print(EventLines& lines) {
  const auto [events, left_out] = lines.take();
  for (const EventLine& line : events) {
    spdlog::log(line.warning ? spdlog::level::warn : spdlog::level::info, "{}", line.text);
  }
  if (left_out > 0) {
    spdlog::warn("{} more lines were left out", left_out);
  }
}

void print_until(const std::stop_token& stop, EventLines& lines) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  while (!stop.stop_requested()) {
    std::unique_lock lock(mutex);
    stopped.wait_for(lock, stop, log_interval, [] { return false; });
    print(lines);
  }
}

Expected<std::vector<BenchFile>> read_benches(const std::vector<std::string>& paths) {
  std::vector<BenchFile> benches;
  for (const auto& path : paths) {
    auto bench = read_bench_file(path);
    if (!bench) {
      return fail(bench.error());
    }
    benches.push_back(std::move(*bench));
  }
  return benches;
}

// One sink and one socket an address.
struct Reception {
  std::vector<std::unique_ptr<EndpointSink>> sinks;
  std::unique_ptr<drivers::smartup::Receiver> receiver;
};

Expected<Reception> open_reception(std::vector<PlannedEndpoint> plan, SourceService& service,
                                   EventLines& lines) {
  Reception reception;
  std::vector<drivers::smartup::Receiver::Endpoint> endpoints;
  for (auto& planned : plan) {
    auto& sink =
        reception.sinks.emplace_back(std::make_unique<EndpointSink>(planned.listen, lines));
    auto& endpoint = endpoints.emplace_back();
    endpoint.listen = planned.listen;
    endpoint.sink = sink.get();
    for (auto& source : planned.sources) {
      auto publisher =
          service.add({.bench = source.bench, .source = source.source, .kind = SourceKind::dau});
      if (!publisher) {
        return fail(publisher.error());
      }
      endpoint.wanted.push_back(source.settings);
      sink->add(std::move(source), std::move(*publisher));
    }
  }
  auto receiver = drivers::smartup::Receiver::create(std::move(endpoints));
  if (!receiver) {
    return fail(ErrorCode::device, receiver.error().message);
  }
  reception.receiver = std::move(*receiver);
  return reception;
}

Expected<void> run(const std::vector<std::string>& paths, NetworkOptions options,
                   const std::stop_token& stop) {
  const auto benches = read_benches(paths);
  if (!benches) {
    return fail(benches.error());
  }
  auto plan = plan_listening(*benches);
  if (!plan) {
    return fail(plan.error());
  }
  for (const BenchFile& bench : *benches) {
    add_network_settings(bench.network, options);
  }
  auto participant = join_network(options, "dyncal-dau");
  if (!participant) {
    return fail(participant.error());
  }

  EventLines lines;
  const auto service = SourceService::create(*participant, {.software = software_version()});
  auto reception = open_reception(*plan, *service, lines);
  if (!reception) {
    return fail(reception.error());
  }
  for (std::size_t i = 0; i < plan->size(); ++i) {
    const int bytes = reception->receiver->receive_buffer_bytes(i);
    spdlog::info("listening at UDP {} for {} sensor{}", (*plan)[i].listen,
                 (*plan)[i].sources.size(), (*plan)[i].sources.size() == 1 ? "" : "s");
    if (bytes < wanted_receive_buffer) {
      spdlog::warn("the system allows a receive buffer of {} bytes only: set net.core.rmem_max to "
                   "{} or more",
                   bytes, wanted_receive_buffer);
    }
  }
  service->start();
  reception->receiver->start();
  print_until(stop, lines);
  reception->receiver->stop();
  service->stop();
  print(lines);
  spdlog::info("stopped");
  return {};
}

} // namespace
} // namespace dyncal::services::dau

int main(int argc, char** argv) {
  using namespace dyncal::services;
  CLI::App app{"Receives SmartUp Units and publishes the samples of their sensors on DDS.",
               "dyncal-dau"};
  app.set_version_flag("--version", build_description());
  std::vector<std::string> benches;
  NetworkOptions network;
  app.add_option("BENCH", benches, "bench files (TOML)")->required();
  add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);
  set_up_log("dyncal-dau");
  const auto result = dau::run(benches, network, stop_on_signals());
  return result ? 0 : report_error(result.error());
}
