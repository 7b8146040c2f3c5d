#include "services/analysis/analysis_service.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{100};

} // namespace

AnalysisService::AnalysisService(bus::Participant participant, AnalysisIdentity identity,
                                 bus::Clock& clock)
    : participant_(std::move(participant)), context_{participant_, clock,
                                                     std::make_shared<bus::WakeUp>(),
                                                     std::move(identity)} {}

Expected<std::unique_ptr<AnalysisService>> AnalysisService::create(bus::Participant participant,
                                                                   AnalysisIdentity identity,
                                                                   bus::Clock& clock) {
  std::unique_ptr<AnalysisService> service(
      new AnalysisService(std::move(participant), std::move(identity), clock));
  if (auto opened = service->open_readers(); !opened) {
    return fail(opened.error());
  }
  return service;
}

Expected<void> AnalysisService::open_readers() {
  const auto& bell = context_.wake_up;
  auto measurement = participant_.reader(bus::topics::measurement, all_benches, bell);
  auto excitation = participant_.reader(bus::topics::excitation, all_benches, bell);
  auto description = participant_.reader(bus::topics::source_description, all_benches, bell);
  auto status = participant_.reader(bus::topics::source_status, all_benches, bell);
  if (auto error = first_error(measurement, excitation, description, status)) {
    return fail(*error);
  }
  readers_ = std::make_unique<Readers>(Readers{std::move(*measurement), std::move(*excitation),
                                               std::move(*description), std::move(*status)});
  return {};
}

void AnalysisService::serve(const std::stop_token& stop) {
  spdlog::info("analysis ready ({} on {})", context_.identity.dds, context_.identity.service);
  bus::Clock& clock = context_.clock;
  while (!stop.stop_requested()) {
    clock.wait(*context_.wake_up, clock.now() + max_wait);
    take_messages();
    for (const RunKey& key : order_) {
      runs_.at(key)->work(benches_[key.first], run_before(key));
    }
  }
}

void AnalysisService::take_messages() {
  readers_->description.take([&](const wire::SourceDescription& description) {
    benches_[description.bench().to_string()][description.source().to_string()].description =
        description;
  });
  readers_->status.take([&](const wire::SourceStatus& status) {
    benches_[status.bench().to_string()][status.source().to_string()].status = status;
  });
  readers_->measurement.take(
      [&](const wire::Measurement& measurement) { take_measurement(measurement); });
  readers_->excitation.take([&](const wire::Excitation& excitation) {
    const auto session = runs_.find({excitation.bench().to_string(), excitation.run().to_string()});
    if (session != runs_.end()) {
      session->second->announce(excitation);
    }
  });
}

void AnalysisService::take_measurement(const wire::Measurement& measurement) {
  const RunKey key{measurement.bench().to_string(), measurement.run().to_string()};
  if (const auto known = runs_.find(key); known != runs_.end()) {
    known->second->update(measurement);
    return;
  }
  if (measurement.state() == wire::MEASUREMENT_PLANNED) {
    begin_run(key, measurement);
    return;
  }
  // Its first samples are gone, and so are the results of another instance that may have died: what
  // came of it would look complete without being so. The run ends by itself if nobody else
  // evaluates it.
  if (ignored_.insert(key).second && measurement.state() == wire::MEASUREMENT_RUNNING) {
    spdlog::warn("bench {}, run {}: began before this service; not evaluated", key.first,
                 key.second);
  }
}

void AnalysisService::begin_run(const RunKey& key, const wire::Measurement& measurement) {
  if (!make_room(key.first)) {
    spdlog::error("bench {}, run {}: not served, {} runs of this bench have not ended", key.first,
                  key.second, kept_runs);
    return;
  }
  auto session = RunSession::create(context_, measurement);
  if (!session) {
    spdlog::error("bench {}, run {}: {}", key.first, key.second, session.error().message);
    return;
  }
  runs_.emplace(key, std::move(*session));
  order_.push_back(key);
}

bool AnalysisService::make_room(const std::string& bench) {
  const auto of_bench = [&](const RunKey& key) { return key.first == bench; };
  while (static_cast<std::size_t>(std::count_if(order_.begin(), order_.end(), of_bench)) >=
         kept_runs) {
    const auto oldest = std::find_if(order_.begin(), order_.end(), [&](const RunKey& key) {
      return of_bench(key) && runs_.at(key)->finished();
    });
    if (oldest == order_.end()) {
      return false;
    }
    runs_.erase(*oldest);
    order_.erase(oldest);
  }
  return true;
}

RunSession* AnalysisService::run_before(const RunKey& key) {
  for (const RunKey& earlier : order_) {
    if (earlier == key) {
      break;
    }
    RunSession& session = *runs_.at(earlier);
    if (earlier.first == key.first && !session.finished()) {
      return &session;
    }
  }
  return nullptr;
}

} // namespace dyncal::services
