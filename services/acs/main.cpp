// dyncal-acs: publishes analogue calibration systems (their TCP streams) and recorded series of any source.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdlib>
#include <fmt/core.h>
#include <optional>
#include <spdlog/spdlog.h>
#include <thread>
#include <vector>

#include "services/acs/played_source.hpp"
#include "services/bench/bench_file.hpp"
#include "services/program/program.hpp"
#include "services/source/source_service.hpp"
#include "services/version.hpp"

namespace {

using namespace dyncal::services;
using dyncal::services::acs::PlayedSource;

constexpr std::chrono::seconds silent_after{2};

struct Part { // a source with the place where it publishes
  PlayedSource source;
  SourceOptions options;
  std::shared_ptr<SourcePublisher> publisher;
};

Expected<std::vector<Part>> prepare(const std::vector<std::string>& files, NetworkOptions& network, const std::stop_token& stop) {
  std::vector<Part> parts;
  for (const std::string& file : files) {
    const auto bench = read_bench_file(file);
    if (!bench) {
      return tl::unexpected(bench.error());
    }
    add_network_settings(bench->network, network);
    for (const SourceSettings& settings : bench->sources) {
      if (settings.driver != SourceDriver::socket && settings.driver != SourceDriver::file) {
        continue; // dyncal-dau, dyncal-can or dyncal-dso publishes it
      }
      auto source = PlayedSource::prepare(settings, stop);
      if (!source) {
        return tl::unexpected(Error{source.error().code, fmt::format("{}: {}", file, source.error().message)});
      }
      SourceOptions options;
      options.bench = bench->bench;
      options.source = settings.name;
      options.kind = acs::kind_of(bench->method, settings.name);
      options.silent_after = settings.driver == SourceDriver::file ? std::chrono::seconds(0) : silent_after;
      parts.push_back({std::move(*source), std::move(options), nullptr});
    }
  }
  if (parts.empty()) {
    return tl::unexpected(Error{ErrorCode::bad_argument, "no source with driver \"socket\" or \"file\" in the bench files given"});
  }
  return parts;
}

// Every source in a thread of its own until all have ended or a stop is requested; the first failure, if there was one.
Expected<void> run_all(std::vector<Part>& parts, std::stop_token stop) {
  std::vector<Expected<void>> outcomes(parts.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      threads.emplace_back([&, i] {
        outcomes[i] = parts[i].source.run(*parts[i].publisher, stop);
        if (!outcomes[i] && parts.size() > 1) { // the others go on; the sentence at the end would come late
          spdlog::error("bench {}: {}", parts[i].options.bench, outcomes[i].error().message);
        }
      });
    }
  }
  for (const Expected<void>& outcome : outcomes) {
    if (!outcome) {
      return outcome;
    }
  }
  return {};
}

Expected<void> run(const std::vector<std::string>& files, NetworkOptions network, const std::stop_token& stop) {
  auto parts = prepare(files, network, stop);
  if (!parts) {
    return tl::unexpected(parts.error());
  }
  auto participant = join_network(network, "dyncal-acs");
  if (!participant) {
    return tl::unexpected(participant.error());
  }
  SourceServiceOptions options;
  options.software = software_version();
  const auto service = SourceService::create(*participant, options);
  for (Part& part : *parts) {
    auto publisher = service->add(part.options);
    if (!publisher) {
      return tl::unexpected(publisher.error());
    }
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
  CLI::App app{"Publishes the sources of bench files whose driver is \"socket\" (an analogue calibration system's TCP stream) or \"file\" "
               "(a recorded series)."};
  std::vector<std::string> files;
  NetworkOptions network;
  app.add_option("bench", files, "bench files")->required();
  add_network_options(app, network);
  CLI11_PARSE(app, argc, argv);

  set_up_log("dyncal-acs");
  const std::stop_token stop = stop_on_signals();
  if (const auto done = run(files, network, stop); !done) {
    return fail(done.error());
  }
  return EXIT_SUCCESS;
}
