// The analysis service: learns benches, sources and recipes from DDS alone and keeps one RunSession
// for every run it hears of.
//
// Runs of one bench are served one after the other (run_session.hpp); benches know nothing of each
// other. Finished runs are kept for late joiners, the newest `kept_runs` of every bench.
//
// Several services share the runs of a network: one leads a run, the others stand by
// (other_analyses.hpp). A run that goes on without a leader, because that one has died or this
// service was restarted, is taken over from its beginning, with what the sources have kept of it.
// Of a leader with other software no run is taken over: its results and ours would stand side by
// side.
//
// serve() runs in the caller's thread until `stop` is requested and calls `turned` at every turn of
// its loop, at least ten times a second; nothing else may be called meanwhile.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/analysis/other_analyses.hpp"
#include "services/analysis/run_session.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/supervision/daemon_metrics.hpp"

namespace dyncal::services {

class AnalysisService {
public:
  static constexpr std::size_t kept_runs = 10;

  // `clock` outlives the service. Fails (network) as readers do.
  [[nodiscard]] static Expected<std::unique_ptr<AnalysisService>>
  create(bus::Participant participant, AnalysisIdentity identity,
         bus::Clock& clock = bus::system_clock());

  void serve(const std::stop_token& stop,
             const std::function<void(const AnalysisFigures&)>& turned = {});

private:
  struct Readers {
    bus::Reader<wire::Measurement> measurement;
    bus::Reader<wire::Excitation> excitation;
    bus::Reader<wire::SourceDescription> description;
    bus::Reader<wire::SourceStatus> status;
    bus::Reader<wire::ServiceStatus> analyses;
  };
  using Instant = bus::Clock::Instant;

  // A run that another service leads, or whose leader is not known yet.
  struct FollowedRun {
    wire::Measurement measurement;
    std::optional<wire::Excitation> excitation;
    Instant since;
    Instant heard;           // of the run
    int messages = 0;        // of the run itself; none as long as only its excitation was heard of
    bool left_alone = false; // its leader had other software
  };

  AnalysisService(bus::Participant participant, AnalysisIdentity identity, bus::Clock& clock);
  Expected<void> open_readers();
  void take_messages();
  void take_measurement(const wire::Measurement& measurement);
  void follow(const RunKey& key, const wire::Measurement& measurement);
  [[nodiscard]] FollowedRun& followed(const RunKey& key);
  [[nodiscard]] bool follows_bench(const std::string& bench) const;
  void begin_run(const RunKey& key, const wire::Measurement& measurement,
                 SourceStreams::Begin begin);
  void give_way();
  void take_over();
  [[nodiscard]] bool is_deserted(const RunKey& key, const FollowedRun& run, Instant now) const;
  // Drops the oldest finished runs beyond kept_runs; false: none of them is finished.
  bool make_room(const std::string& bench);
  // Null if none of the runs of this bench that began earlier goes on.
  [[nodiscard]] RunSession* run_before(const RunKey& key);
  [[nodiscard]] AnalysisFigures figures() const;

  bus::Participant participant_;
  AnalysisContext context_; // of participant_
  std::unique_ptr<Readers> readers_;
  std::map<std::string, KnownSources> benches_;
  std::map<RunKey, std::unique_ptr<RunSession>> runs_;
  std::vector<RunKey> order_; // of runs_, oldest first
  OtherAnalyses others_;
  std::map<RunKey, FollowedRun> followed_;
  double evaluation_s_ = 0.0; // that serve() has spent with runs
};

} // namespace dyncal::services
