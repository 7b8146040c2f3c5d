// dyncal-can BENCH.toml...: publishes the sensors on CAN interfaces of this host.
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "services/bench/bench_file.hpp"
#include "services/can/can_source.hpp"
#include "services/program/program.hpp"
#include "services/source/source_service.hpp"
#include "services/version.hpp"

namespace {

using namespace dyncal::services;

struct Part { // a source with the place where it publishes
  can::CanSource source;
  SourceOptions options;
  std::shared_ptr<SourcePublisher> publisher;
};

Expected<std::vector<Part>> prepare(const std::vector<std::string>& files, NetworkOptions& network) {
  std::vector<Part> parts;
  for (const std::string& file : files) {
    const auto bench = read_bench_file(file);
    if (!bench) return tl::unexpected(bench.error());
    add_network_settings(bench->network, network);
    for (const SourceSettings& settings : bench->sources) {
      if (settings.driver != SourceDriver::can) continue; // others publish it
      auto source = can::CanSource::prepare(settings);
      if (!source) return tl::unexpected(Error{source.error().code, fmt::format("{}: {}", settings.where, source.error().message)});
      for (const std::string& warning : source->warnings())
        spdlog::warn("{}", warning);
      SourceOptions options;
      options.bench = bench->bench;
      options.source = settings.name;
      options.kind = SourceKind::can;
      parts.push_back({std::move(*source), std::move(options), nullptr});
    }
  }
  if (parts.empty()) return tl::unexpected(Error{ErrorCode::bad_argument, "no source with driver \"can\" in the bench files given"});
  return parts;
}

// Every source in a thread of its own; the first failure, if there was one.
Expected<void> run_all(std::vector<Part>& parts, const std::stop_token& stop) {
  std::vector<Expected<void>> outcomes(parts.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < parts.size(); ++i)
      threads.emplace_back([&, i] {
        outcomes[i] = parts[i].source.run(*parts[i].publisher, stop);
        if (!outcomes[i]) spdlog::error("bench {}: {}", parts[i].options.bench, outcomes[i].error().message);
      });
  }
  for (const Expected<void>& outcome : outcomes)
    if (!outcome) return outcome;
  return {};
}

Expected<void> run(const std::vector<std::string>& files, NetworkOptions network, const std::stop_token& stop) {
  auto parts = prepare(files, network);
  if (!parts) return tl::unexpected(parts.error());
  auto participant = join_network(network, "dyncal-can");
  if (!participant) return tl::unexpected(participant.error());
  const auto service = SourceService::create(*participant, {.software = software_version()});
  for (Part& part : *parts) {
    auto publisher = service->add(part.options);
    if (!publisher) return tl::unexpected(publisher.error());
    part.publisher = std::move(*publisher);
    spdlog::info("bench {}, source {}", part.options.bench, part.options.source);
  }
  service->start();
  auto done = run_all(*parts, stop);
  service->stop();
  return done;
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app{"Publishes the sources of bench files whose driver is \"can\": sensors on CAN and CAN FD interfaces of this host.",
               "dyncal-can"};
  std::vector<std::string> files;
  NetworkOptions network;
  app.add_option("BENCH", files, "bench files (TOML)")->required();
  add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);

  set_up_log("dyncal-can");
  const std::stop_token stop = stop_on_signals();
  if (const auto done = run(files, network, stop); !done) return fail(done.error());
  return EXIT_SUCCESS;
}
