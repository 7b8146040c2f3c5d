#include "services/analysis/analysis_service.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "services/contract/topics.hpp"

namespace dyncal::services {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{100};

} // namespace

AnalysisService::AnalysisService(bus::Participant participant, AnalysisIdentity identity)
    : participant_(std::move(participant)), identity_(std::move(identity)),
      wake_up_(std::make_shared<bus::WakeUp>()) {}

Expected<std::unique_ptr<AnalysisService>> AnalysisService::create(bus::Participant participant,
                                                                   AnalysisIdentity identity) {
  std::unique_ptr<AnalysisService> service(
      new AnalysisService(std::move(participant), std::move(identity)));
  if (auto opened = service->open_readers(); !opened) {
    return fail(opened.error());
  }
  return service;
}

Expected<void> AnalysisService::open_readers() {
  auto measurement = participant_.reader<wire::Measurement>(
      bus::topics::measurement, bus::Profile::state, all_benches, wake_up_);
  auto excitation = participant_.reader<wire::Excitation>(
      bus::topics::excitation, bus::Profile::state, all_benches, wake_up_);
  auto description = participant_.reader<wire::SourceDescription>(
      bus::topics::source_description, bus::Profile::state, all_benches, wake_up_);
  auto status = participant_.reader<wire::SourceStatus>(bus::topics::source_status,
                                                        bus::Profile::state, all_benches, wake_up_);
  for (const Error* error :
       {measurement ? nullptr : &measurement.error(), excitation ? nullptr : &excitation.error(),
        description ? nullptr : &description.error(), status ? nullptr : &status.error()}) {
    if (error != nullptr) {
      return fail(*error);
    }
  }
  readers_ = std::make_unique<Readers>(Readers{std::move(*measurement), std::move(*excitation),
                                               std::move(*description), std::move(*status)});
  return {};
}

void AnalysisService::serve(const std::stop_token& stop) {
  spdlog::info("analysis ready ({} on {})", identity_.dds, identity_.service);
  while (!stop.stop_requested()) {
    wake_up_->wait_until(RunSession::Clock::now() + max_wait);
    take_messages();
    for (auto& [key, session] : runs_) {
      session->work(benches_[key.first], RunSession::Clock::now());
    }
  }
}

void AnalysisService::take_messages() {
  readers_->description.take(
      [&](const wire::SourceDescription& description, const bus::SampleInfo& info) {
        if (info.valid) {
          benches_[description.bench().to_string()][description.source().to_string()].description =
              description;
        }
      });
  readers_->status.take([&](const wire::SourceStatus& status, const bus::SampleInfo& info) {
    if (info.valid) {
      benches_[status.bench().to_string()][status.source().to_string()].status = status;
    } else {
      benches_[status.bench().to_string()].erase(status.source().to_string());
    }
  });
  readers_->measurement.take(
      [&](const wire::Measurement& measurement, const bus::SampleInfo& info) {
        if (info.valid) {
          take_measurement(measurement);
        }
      });
  readers_->excitation.take([&](const wire::Excitation& excitation, const bus::SampleInfo& info) {
    const auto session = runs_.find({excitation.bench().to_string(), excitation.run().to_string()});
    if (info.valid && session != runs_.end()) {
      session->second->announce(excitation);
    }
  });
}

void AnalysisService::take_measurement(const wire::Measurement& measurement) {
  const RunKey key{measurement.bench().to_string(), measurement.run().to_string()};
  const auto now = RunSession::Clock::now();
  if (const auto known = runs_.find(key); known != runs_.end()) {
    known->second->update(measurement, now);
    return;
  }
  if (measurement.state() != wire::MEASUREMENT_PLANNED) {
    // Its first samples are gone, and so are the results of another instance that may have died:
    // what came of it would look complete and not be. The run ends by itself when nobody else
    // evaluates it.
    if (ignored_.insert(key).second && measurement.state() == wire::MEASUREMENT_RUNNING) {
      spdlog::warn("bench {}, run {}: began before this service; not evaluated", key.first,
                   key.second);
    }
    return;
  }
  auto session = RunSession::create(participant_, wake_up_, identity_, measurement, now);
  if (!session) {
    spdlog::error("bench {}, run {}: {}", key.first, key.second, session.error().message);
    return;
  }
  drop_old_runs(key.first);
  runs_.emplace(key, std::move(*session));
  order_.push_back(key);
}

void AnalysisService::drop_old_runs(const std::string& bench) {
  const auto of_bench = [&](const RunKey& key) { return key.first == bench; };
  while (static_cast<std::size_t>(std::count_if(order_.begin(), order_.end(), of_bench)) >=
         kept_runs) {
    const auto oldest = std::find_if(order_.begin(), order_.end(), of_bench);
    runs_.erase(*oldest);
    order_.erase(oldest);
  }
}

} // namespace dyncal::services
