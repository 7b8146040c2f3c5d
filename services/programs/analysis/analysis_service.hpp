// The analysis service: learns benches, sources and recipes from DDS alone and keeps one RunSession
// for every run it hears of.
//
// Runs of one bench are served one after the other (run_session.hpp); benches know nothing of each
// other. Finished runs are kept for late joiners, the newest `kept_runs` of every bench and
// `max_runs` of all: few, since every program that joins the network is told of the writers of
// each.
//
// All that the wire can make it keep has a limit (here, known_benches.hpp, other_analyses.hpp,
// followed_runs.hpp). What lives is never dropped for something new: a run that is armed, or one
// that waits and of which a source is there. What had no room is counted, and said once for each
// kind.
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
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/daemon/supervision/daemon_metrics.hpp"
#include "services/programs/analysis/followed_runs.hpp"
#include "services/programs/analysis/known_benches.hpp"
#include "services/programs/analysis/other_analyses.hpp"
#include "services/programs/analysis/run_session.hpp"

namespace dyncal::inline programs {

class AnalysisService {
public:
  static constexpr std::size_t kept_runs = 3;
  static constexpr std::size_t max_runs = 256;

  // `clock` outlives the service. Fails (network) as readers do.
  [[nodiscard]] static Expected<std::unique_ptr<AnalysisService>>
  create(bus::Participant participant, AnalysisIdentity identity,
         bus::Clock& clock = bus::system_clock());

  void serve(const std::stop_token& stop,
             const std::function<void(const AnalysisFigures&)>& turned = {});

private:
  struct SourceReaders {
    bus::Reader<wire::SourceDescription> description;
    bus::Reader<wire::SourceStatus> status;
  };
  struct Readers {
    bus::Reader<wire::Measurement> measurement;
    bus::Reader<wire::Excitation> excitation;
    SourceReaders sources;
    bus::Reader<wire::ServiceStatus> analyses;
  };
  using Instant = bus::Clock::Instant;
  using Wanted = std::function<bool(const std::string& bench, const std::string& source)>;
  using Runs = std::map<RunKey, std::unique_ptr<RunSession>>;

  AnalysisService(bus::Participant participant, AnalysisIdentity identity, bus::Clock& clock);
  Expected<void> open_readers();
  [[nodiscard]] Expected<SourceReaders> open_source_readers(const std::string& bench);
  void take_messages();
  void take_sources(SourceReaders& readers, const Wanted& wanted);
  static void watch_for_twins(KnownSource& source);
  // Of the run that has just begun: their descriptions may have had no room.
  void read_sources_again(const std::string& bench);
  void leave_benches_without_run();
  void take_measurement(const wire::Measurement& measurement);
  void begin_run(const RunKey& key, const wire::Measurement& measurement,
                 SourceStreams::Begin begin);
  // Of the runs of this bench that are kept, or new.
  [[nodiscard]] Expected<std::shared_ptr<SourceRequests>> requests_to(const std::string& bench);
  void give_way();
  void take_over();
  // One turn of each run that goes on.
  void work();
  // Armed, or with a source that is there.
  [[nodiscard]] bool lives(const Runs::value_type& run) const;
  // Some run that has not ended is to be evaluated from this source.
  [[nodiscard]] bool is_used(const std::string& bench, const std::string& source) const;
  // False: all runs of the bench, or all of them, live.
  bool make_room(const std::string& bench);
  // The oldest of those that have finished, else of those that do not live.
  bool drop_oldest(const std::function<bool(const RunKey&)>& may_go);
  void say_what_was_left_out();
  [[nodiscard]] AnalysisFigures figures() const;

  bus::Participant participant_;
  AnalysisContext context_; // of participant_
  std::unique_ptr<Readers> readers_;
  KnownBenches benches_;
  std::map<std::string, SourceReaders> again_; // of benches with a run
  Runs runs_;
  std::vector<Runs::iterator> order_; // oldest first
  OtherAnalyses others_;
  FollowedRuns followed_{others_};
  std::uint64_t runs_left_out_ = 0;
  std::set<std::string> said_; // of what was left out
  double evaluation_s_ = 0.0;  // that serve() has spent with runs
};

} // namespace dyncal::inline programs
