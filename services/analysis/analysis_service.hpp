// The analysis service: learns benches, sources and recipes from DDS alone and keeps one RunSession
// for every run it hears of.
//
// Runs of one bench are served one after the other (run_session.hpp); benches know nothing of each
// other. Only runs that are PLANNED when they are first heard of are evaluated: of one that began
// before, samples are lost. Finished runs are kept for late joiners, the newest `kept_runs` of
// every bench.
//
// serve() runs in the caller's thread until `stop` is requested; nothing else may be called
// meanwhile.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "services/analysis/run_session.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"

namespace dyncal::services {

class AnalysisService {
public:
  static constexpr std::size_t kept_runs = 10;

  // `clock` outlives the service. Fails (network) as readers do.
  [[nodiscard]] static Expected<std::unique_ptr<AnalysisService>>
  create(bus::Participant participant, AnalysisIdentity identity,
         bus::Clock& clock = bus::system_clock());

  void serve(const std::stop_token& stop);

private:
  struct Readers {
    bus::Reader<wire::Measurement> measurement;
    bus::Reader<wire::Excitation> excitation;
    bus::Reader<wire::SourceDescription> description;
    bus::Reader<wire::SourceStatus> status;
  };
  using RunKey = std::pair<std::string, std::string>; // bench, run

  AnalysisService(bus::Participant participant, AnalysisIdentity identity, bus::Clock& clock);
  Expected<void> open_readers();
  void take_messages();
  void take_measurement(const wire::Measurement& measurement);
  void begin_run(const RunKey& key, const wire::Measurement& measurement);
  // Drops the oldest finished runs beyond kept_runs; false: none of them is finished.
  bool make_room(const std::string& bench);
  // Null if none of the runs of this bench that began earlier goes on.
  [[nodiscard]] RunSession* run_before(const RunKey& key);

  bus::Participant participant_;
  AnalysisContext context_; // of participant_
  std::unique_ptr<Readers> readers_;
  std::map<std::string, KnownSources> benches_;
  std::map<RunKey, std::unique_ptr<RunSession>> runs_;
  std::vector<RunKey> order_; // of runs_, oldest first
  std::set<RunKey> ignored_;  // began before this service
};

} // namespace dyncal::services
