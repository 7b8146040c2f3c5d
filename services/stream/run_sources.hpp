// The sources of one program, run beside each other: every one in a thread of its own, until all
// have ended or a stop is requested.
//
// A source is a movable class with `Expected<void> run(SourcePublisher&, std::stop_token)`, which
// blocks; its header tells when it ends and fails. run_sources() announces every source, runs them
// and returns the first failure, if there was one. A source that fails is logged at once and does
// not end the others. Blocks its caller.
#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <spdlog/spdlog.h>

#include "services/base/error.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/stream/source_service.hpp"
#include "services/stream/supervised.hpp"

namespace dyncal::inline stream {

template <class Source>
struct RunnableSource {
  Source source;
  SourceOptions options; // where it publishes
};

template <class Source>
[[nodiscard]] Expected<void> run_sources(Daemon& daemon,
                                         std::vector<RunnableSource<Source>>& sources) {
  const std::stop_token stop = daemon.stop();
  const auto service = SourceService::create(
      daemon.participant(),
      supervised(daemon.supervisor(), daemon.participant(), !daemon.network.security.empty()));
  std::vector<std::shared_ptr<SourcePublisher>> publishers;
  for (RunnableSource<Source>& one : sources) {
    one.options.stop = stop;
    DYNCAL_TRY(auto publisher, service->add(one.options));
    publishers.push_back(std::move(publisher));
    spdlog::info("bench {}, source {}", one.options.bench, one.options.source);
  }
  service->start();
  daemon.supervisor().serving();
  std::vector<Expected<void>> outcomes(sources.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      threads.emplace_back([&, i] {
        outcomes[i] = sources[i].source.run(*publishers[i], stop);
        if (!outcomes[i] &&
            sources.size() > 1) { // the others go on; the sentence at the end would come late
          spdlog::error("bench {}: {}", sources[i].options.bench, outcomes[i].error().message);
        }
      });
    }
  }
  service->stop();
  for (const Expected<void>& outcome : outcomes) {
    if (!outcome) {
      return outcome;
    }
  }
  return {};
}

} // namespace dyncal::inline stream
