#include "services/programs/analysis/analysis_service.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "services/base/version.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline programs {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{100};

std::string in_brackets(const std::string& service) {
  return service.empty() ? "" : " (" + service + ")";
}

} // namespace

AnalysisService::AnalysisService(bus::Participant participant, AnalysisIdentity identity,
                                 bus::Clock& clock)
    : participant_(std::move(participant)), context_{participant_, clock,
                                                     std::make_shared<bus::WakeUp>(),
                                                     std::move(identity)},
      benches_({[this](const std::string& bench) {
                  return std::ranges::any_of(runs_, [&](const auto& run) {
                    return run.first.first == bench && lives(run);
                  });
                },
                [this](const std::string& bench, const std::string& source) {
                  return is_used(bench, source);
                }}),
      others_(context_.identity.service, [this](const RunKey& key) {
        return runs_.contains(key) || followed_.messages(key) > 1;
      }) {}

Expected<std::unique_ptr<AnalysisService>> AnalysisService::create(bus::Participant participant,
                                                                   AnalysisIdentity identity,
                                                                   bus::Clock& clock) {
  std::unique_ptr<AnalysisService> service(
      new AnalysisService(std::move(participant), std::move(identity), clock));
  DYNCAL_TRY(service->open_readers());
  return service;
}

Expected<void> AnalysisService::open_readers() {
  const auto& bell = context_.wake_up;
  DYNCAL_TRY(auto measurement, participant_.reader(bus::topics::measurement, all_benches, bell));
  DYNCAL_TRY(auto excitation, participant_.reader(bus::topics::excitation, all_benches, bell));
  DYNCAL_TRY(auto sources, open_source_readers(all_benches));
  DYNCAL_TRY(auto analyses, participant_.reader(bus::topics::service_status, all_benches, bell));
  readers_ = std::make_unique<Readers>(Readers{std::move(measurement), std::move(excitation),
                                               std::move(sources), std::move(analyses)});
  return {};
}

Expected<AnalysisService::SourceReaders>
AnalysisService::open_source_readers(const std::string& bench) {
  const auto& bell = context_.wake_up;
  DYNCAL_TRY(auto description, participant_.reader(bus::topics::source_description, bench, bell));
  DYNCAL_TRY(auto status, participant_.reader(bus::topics::source_status, bench, bell));
  return SourceReaders{std::move(description), std::move(status)};
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
    leave_benches_without_run();
    say_what_was_left_out();
    const auto began = clock.now();
    work();
    evaluation_s_ += std::chrono::duration<double>(clock.now() - began).count();
  }
}

void AnalysisService::work() {
  std::map<std::string, RunSession*> first_that_goes_on; // of each bench, up to the one at work
  for (const auto& run : order_) {
    const std::string& bench = run->first.first;
    RunSession& session = *run->second;
    if (session.finished()) {
      continue;
    }
    RunSession*& before = first_that_goes_on[bench];
    session.work(benches_.sources_of(bench), before);
    if (before == nullptr || before->finished()) {
      before = session.finished() ? nullptr : &session;
    }
  }
}

void AnalysisService::take_messages() {
  take_sources(readers_->sources, [](const auto&, const auto&) { return true; });
  readers_->analyses.take(
      [&](const wire::ServiceStatus& status) { others_.add(status, context_.clock.now()); });
  readers_->measurement.take(
      [&](const wire::Measurement& measurement) { take_measurement(measurement); });
  readers_->excitation.take([&](const wire::Excitation& excitation) {
    const RunKey key{excitation.bench().to_string(), excitation.run().to_string()};
    if (const auto session = runs_.find(key); session != runs_.end()) {
      session->second->announce(excitation);
    } else {
      followed_.add(key, excitation, context_.clock.now());
    }
  });
  for (auto& [bench, sources] : again_) { // last, so that nothing new drops them before work()
    take_sources(sources, [this](const std::string& of, const std::string& source) {
      return is_used(of, source);
    });
  }
}

void AnalysisService::take_sources(SourceReaders& readers, const Wanted& wanted) {
  const Instant now = context_.clock.now();
  // What comes a second time for a bench with a run would let sessions take turns that do not.
  const bool comes_first = &readers == &readers_->sources;
  const auto known = [&](const auto& message) {
    const std::string bench = message.bench().to_string();
    const std::string source = message.source().to_string();
    return wanted(bench, source) ? benches_.heard(bench, source, now) : nullptr;
  };
  readers.description.take([&](const wire::SourceDescription& description) {
    if (KnownSource* source = known(description)) {
      source->take(description);
    }
  });
  readers.status.take([&](const wire::SourceStatus& status) {
    if (KnownSource* source = known(status)) {
      if (const auto left = source->take(status)) {
        spdlog::warn("bench {}, source {}: the service{} that described itself as this source has "
                     "gone; the one{} before it goes on, by its own description",
                     status.bench().to_string(), status.source().to_string(),
                     in_brackets(service_of(left)), in_brackets(service_of(source->description)));
      }
      if (comes_first) {
        watch_for_twins(*source);
      }
    }
  });
}

// Seen while nothing runs, so that no run begins on them.
void AnalysisService::watch_for_twins(KnownSource& source) {
  const bool known = source.twins.twins();
  source.twins.add(source.status->session());
  if (!known && source.twins.twins()) {
    spdlog::warn(two_send_as(source.status->bench().to_string(),
                             source.status->source().to_string(), service_of(source.before()),
                             service_of(source.description)));
  }
}

void AnalysisService::read_sources_again(const std::string& bench) {
  if (again_.contains(bench)) {
    return;
  }
  auto sources = open_source_readers(bench);
  if (!sources) {
    spdlog::error("bench {}: {}", bench, sources.error().message);
    return;
  }
  again_.emplace(bench, std::move(*sources));
}

void AnalysisService::leave_benches_without_run() {
  std::erase_if(again_, [this](const auto& one) {
    return std::ranges::none_of(runs_, [&](const auto& run) {
      return run.first.first == one.first && !run.second->finished();
    });
  });
}

void AnalysisService::take_measurement(const wire::Measurement& measurement) {
  const RunKey key{measurement.bench().to_string(), measurement.run().to_string()};
  if (const auto session = runs_.find(key); session != runs_.end()) {
    session->second->update(measurement);
    return;
  }
  // Who leads the run before on this bench leads the next one, too: it alone knows its end.
  const Instant now = context_.clock.now();
  const bool begins =
      measurement.state() == wire::MEASUREMENT_PLANNED && followed_.messages(key) == 0;
  if (begins && !others_.leader(key, now) && !followed_.leads_other(key.first, now)) {
    followed_.erase(key);
    begin_run(key, measurement, SourceStreams::Begin::with_answer);
  } else {
    followed_.add(key, measurement, now);
  }
}

void AnalysisService::begin_run(const RunKey& key, const wire::Measurement& measurement,
                                SourceStreams::Begin begin) {
  if (!make_room(key.first)) {
    ++runs_left_out_;
    return;
  }
  auto session = requests_to(key.first).and_then([&](auto requests) {
    return RunSession::create(context_, measurement, std::move(requests), begin);
  });
  if (!session) {
    spdlog::error("bench {}, run {}: {}", key.first, key.second, session.error().message);
    return;
  }
  order_.push_back(runs_.emplace(key, std::move(*session)).first);
  if (benches_.left_out().benches > 0 || benches_.left_out().sources > 0) {
    read_sources_again(key.first);
  }
}

Expected<std::shared_ptr<SourceRequests>> AnalysisService::requests_to(const std::string& bench) {
  for (const auto& [key, session] : runs_) {
    if (key.first == bench) {
      return session->requests();
    }
  }
  return SourceRequests::open(participant_, bench, context_.identity.service);
}

// Runs that another service has begun as well, and leads.
void AnalysisService::give_way() {
  const Instant now = context_.clock.now();
  std::erase_if(order_, [&](const Runs::iterator& run) {
    const auto& [key, session] = *run;
    if (session->finished() || !others_.must_give_way(key, session->armed(), now)) {
      return false;
    }
    spdlog::info("bench {}, run {}: led by {}; this service stands by", key.first, key.second,
                 others_.leader(key, now)->service);
    followed_.add(key, session->measurement(), now);
    runs_.erase(run);
    return true;
  });
}

void AnalysisService::take_over() {
  const Instant now = context_.clock.now();
  while (auto* const deserted = followed_.deserted(now)) {
    const RunKey key = deserted->first;
    FollowedRun& run = deserted->second;
    const auto last = others_.last_leader(key);
    // An analysis that was started again does not know who led; the run does.
    const std::string began_with = last ? last->software : run.measurement.analysis_software();
    if (!began_with.empty() && began_with != software_version()) {
      run.left_alone = true;
      spdlog::error("bench {}, run {}: {} with {} has gone silent; this service has {} and does "
                    "not take the run over: end it, and give all analysis services one version",
                    key.first, key.second, last ? last->service : "an analysis service", began_with,
                    software_version());
      continue;
    }
    spdlog::warn("bench {}, run {}: taken over{}", key.first, key.second,
                 last ? " from " + last->service : "");
    const bool planned = run.measurement.state() == wire::MEASUREMENT_PLANNED;
    begin_run(key, run.measurement,
              planned ? SourceStreams::Begin::with_answer : SourceStreams::Begin::behind);
    const auto session = runs_.find(key);
    if (run.excitation && session != runs_.end()) {
      session->second->announce(*run.excitation);
    }
    followed_.erase(key);
  }
}

bool AnalysisService::lives(const Runs::value_type& run) const {
  const auto& [key, session] = run;
  const KnownSources& known = benches_.sources_of(key.first);
  const auto is_its_source = [&session = *session](const auto& source) {
    return source.second.description && session.uses(source.first);
  };
  return session->armed() || (!session->finished() && std::ranges::any_of(known, is_its_source));
}

bool AnalysisService::is_used(const std::string& bench, const std::string& source) const {
  return std::ranges::any_of(runs_, [&](const auto& run) {
    return run.first.first == bench && !run.second->finished() && run.second->uses(source);
  });
}

bool AnalysisService::make_room(const std::string& bench) {
  const auto of_bench = [&](const RunKey& key) { return key.first == bench; };
  const auto kept = [&] {
    return static_cast<std::size_t>(
        std::ranges::count_if(runs_, [&](const auto& run) { return of_bench(run.first); }));
  };
  while (kept() >= kept_runs) {
    if (!drop_oldest(of_bench)) {
      return false;
    }
  }
  return order_.size() < max_runs || drop_oldest([](const RunKey&) { return true; });
}

bool AnalysisService::drop_oldest(const std::function<bool(const RunKey&)>& may_go) {
  auto oldest = std::ranges::find_if(order_, [&](const Runs::iterator& run) {
    return may_go(run->first) && run->second->finished();
  });
  if (oldest == order_.end()) {
    oldest = std::ranges::find_if(
        order_, [&](const Runs::iterator& run) { return may_go(run->first) && !lives(*run); });
    if (oldest == order_.end()) {
      return false;
    }
    ++runs_left_out_;
  }
  runs_.erase(*oldest);
  order_.erase(oldest);
  return true;
}

void AnalysisService::say_what_was_left_out() {
  const auto say = [this](const char* what, std::uint64_t count, std::size_t limit) {
    if (count > 0 && said_.insert(what).second) {
      spdlog::warn("more {} on the network than this service keeps ({}): some were left out, or "
                   "dropped for newer ones; those of living runs stay; it is counted, and not said "
                   "again",
                   what, limit);
    }
  };
  say("benches", benches_.left_out().benches, KnownBenches::max_benches);
  say("sources of a bench", benches_.left_out().sources, KnownBenches::max_sources);
  say("runs", runs_left_out_ + followed_.left_out(), max_runs);
  say("runs of other analyses", others_.left_out(), OtherAnalyses::max_runs);
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
  figures.benches = benches_.benches();
  figures.sources = benches_.sources();
  figures.runs_of_others = followed_.size();
  figures.left_out = {{"benches", benches_.left_out().benches},
                      {"sources", benches_.left_out().sources},
                      {"runs", runs_left_out_ + followed_.left_out()},
                      {"runs_of_others", others_.left_out()}};
  figures.left_out_of_sources = context_.left_out->figures();
  figures.malformed_messages = participant_.malformed_messages();
  figures.refused_packets = participant_.refused_packets()->count();
  return figures;
}

} // namespace dyncal::inline programs
