#include "services/analysis/analysis_service.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "services/contract/topics.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{100};
constexpr std::size_t max_followed = 1000; // runs; their messages hold whole recipes

} // namespace

AnalysisService::AnalysisService(bus::Participant participant, AnalysisIdentity identity,
                                 bus::Clock& clock)
    : participant_(std::move(participant)), context_{participant_, clock,
                                                     std::make_shared<bus::WakeUp>(),
                                                     std::move(identity)},
      others_(context_.identity.service) {}

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
  auto analyses = participant_.reader(bus::topics::service_status, all_benches, bell);
  if (auto error = first_error(measurement, excitation, description, status, analyses)) {
    return fail(*error);
  }
  readers_ = std::make_unique<Readers>(Readers{std::move(*measurement), std::move(*excitation),
                                               std::move(*description), std::move(*status),
                                               std::move(*analyses)});
  return {};
}

void AnalysisService::serve(const std::stop_token& stop,
                            const std::function<void(const AnalysisFigures&)>& turned) {
  spdlog::info("analysis ready ({} on {})", context_.identity.dds, context_.identity.service);
  bus::Clock& clock = context_.clock;
  while (!stop.stop_requested()) {
    if (turned) {
      turned(figures());
    }
    clock.wait(*context_.wake_up, clock.now() + max_wait);
    take_messages();
    give_way();
    take_over();
    const auto began = clock.now();
    for (const RunKey& key : order_) {
      runs_.at(key)->work(benches_[key.first], run_before(key));
    }
    evaluation_s_ += std::chrono::duration<double>(clock.now() - began).count();
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
  readers_->analyses.take(
      [&](const wire::ServiceStatus& status) { others_.add(status, context_.clock.now()); });
  readers_->measurement.take(
      [&](const wire::Measurement& measurement) { take_measurement(measurement); });
  readers_->excitation.take([&](const wire::Excitation& excitation) {
    const RunKey key{excitation.bench().to_string(), excitation.run().to_string()};
    if (const auto session = runs_.find(key); session != runs_.end()) {
      session->second->announce(excitation);
    } else { // perhaps before anything was heard of its run: topics have no order among each other
      followed(key).excitation = excitation;
    }
  });
}

void AnalysisService::take_measurement(const wire::Measurement& measurement) {
  const RunKey key{measurement.bench().to_string(), measurement.run().to_string()};
  if (const auto session = runs_.find(key); session != runs_.end()) {
    session->second->update(measurement);
    return;
  }
  // Who leads the run before on this bench leads the next one, too: it alone knows its end.
  const auto known = followed_.find(key);
  const bool is_new = known == followed_.end() || known->second.messages == 0;
  const bool begins = measurement.state() == wire::MEASUREMENT_PLANNED && is_new;
  if (begins && !others_.leader(key, context_.clock.now()) && !follows_bench(key.first)) {
    followed_.erase(key);
    begin_run(key, measurement, SourceStreams::Begin::with_answer);
  } else {
    follow(key, measurement);
  }
}

void AnalysisService::follow(const RunKey& key, const wire::Measurement& measurement) {
  FollowedRun& run = followed(key);
  const Instant now = context_.clock.now();
  run.since = run.messages == 0 ? now : run.since;
  run.measurement = measurement;
  run.heard = now;
  ++run.messages;
}

AnalysisService::FollowedRun& AnalysisService::followed(const RunKey& key) {
  if (const auto known = followed_.find(key); known != followed_.end()) {
    return known->second;
  }
  if (followed_.size() >= max_followed) {
    followed_.erase(
        std::min_element(followed_.begin(), followed_.end(), [](const auto& a, const auto& b) {
          return a.second.heard < b.second.heard;
        }));
  }
  FollowedRun& run = followed_[key];
  run.since = run.heard = context_.clock.now();
  return run;
}

bool AnalysisService::follows_bench(const std::string& bench) const {
  const Instant now = context_.clock.now();
  return std::any_of(followed_.begin(), followed_.end(), [&](const auto& one) {
    const auto& [key, run] = one;
    const auto leader = others_.leader(key, now);
    return key.first == bench && leader && leader->arm != wire::ARM_FINISHED &&
           leader->arm != wire::ARM_REFUSED;
  });
}

void AnalysisService::begin_run(const RunKey& key, const wire::Measurement& measurement,
                                SourceStreams::Begin begin) {
  if (!make_room(key.first)) {
    spdlog::error("bench {}, run {}: not served, {} runs of this bench have not ended", key.first,
                  key.second, kept_runs);
    return;
  }
  auto session = RunSession::create(context_, measurement, begin);
  if (!session) {
    spdlog::error("bench {}, run {}: {}", key.first, key.second, session.error().message);
    return;
  }
  runs_.emplace(key, std::move(*session));
  order_.push_back(key);
}

// Runs that another service has begun as well, and leads.
void AnalysisService::give_way() {
  const Instant now = context_.clock.now();
  for (const RunKey& key : std::vector(order_)) {
    const RunSession& session = *runs_.at(key);
    if (session.finished() || !others_.must_give_way(key, session.armed(), now)) {
      continue;
    }
    spdlog::info("bench {}, run {}: led by {}; this service stands by", key.first, key.second,
                 others_.leader(key, now)->service);
    follow(key, session.measurement());
    runs_.erase(key);
    std::erase(order_, key);
  }
}

// Heard of more than once: the last word of a run that has ended stays readable for a while.
bool AnalysisService::is_deserted(const RunKey& key, const FollowedRun& run, Instant now) const {
  const auto last = others_.last_leader(key);
  if (last && (last->arm == wire::ARM_FINISHED || last->arm == wire::ARM_REFUSED)) {
    return false;
  }
  const Instant led_until = last ? std::max(last->heard, run.since) : run.since;
  return run.messages > 1 && now - led_until > OtherAnalyses::silence_limit &&
         now - run.heard <= OtherAnalyses::silence_limit;
}

void AnalysisService::take_over() {
  const Instant now = context_.clock.now();
  for (auto run = followed_.begin(); run != followed_.end();) {
    auto& [key, followed] = *run;
    if (followed.left_alone || !is_deserted(key, followed, now)) {
      ++run;
      continue;
    }
    const auto last = others_.last_leader(key);
    if (last && last->software != software_version()) {
      followed.left_alone = true;
      spdlog::error("bench {}, run {}: {} with {} has gone silent; this service has {} and does "
                    "not take the run over: end it, and give all analysis services one version",
                    key.first, key.second, last->service, last->software, software_version());
      ++run;
      continue;
    }
    spdlog::warn("bench {}, run {}: taken over{}", key.first, key.second,
                 last ? " from " + last->service : "");
    const bool planned = followed.measurement.state() == wire::MEASUREMENT_PLANNED;
    begin_run(key, followed.measurement,
              planned ? SourceStreams::Begin::with_answer : SourceStreams::Begin::behind);
    const auto session = runs_.find(key);
    if (followed.excitation && session != runs_.end()) {
      session->second->announce(*followed.excitation);
    }
    run = followed_.erase(run);
  }
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

AnalysisFigures AnalysisService::figures() const {
  AnalysisFigures figures;
  for (const auto& [key, run] : runs_) {
    switch (run->arm_state()) {
    case wire::ARM_WAITING:
      ++figures.runs_waiting;
      break;
    case wire::ARM_ARMED:
      ++figures.runs_armed;
      break;
    case wire::ARM_REFUSED:
      ++figures.runs_refused;
      break;
    case wire::ARM_FINISHED:
      ++figures.runs_finished;
      break;
    }
  }
  figures.evaluation_s = evaluation_s_;
  figures.malformed_messages = participant_.malformed_messages();
  figures.refused_packets = participant_.refused_packets()->count();
  return figures;
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
