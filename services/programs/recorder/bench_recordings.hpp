// Which file each bench is recorded in, and from when to when.
//
// A bench is recorded from the moment it is known: named beforehand, or heard of by a description
// of its sources or by a run. Each run has a file of its own, from its announcement until its
// analysis has finished and what was missed has been given again, or `end_limit` after its end, or
// until the next run; a run that went on when the recorder was started, too. Between runs another
// file is written, unless only runs are wanted; one that is larger than `max_file_bytes` is
// followed by the next. A recording that ended by itself (disk full) is not started over before the
// next run, or before its time is over: its status goes on saying why.
//
// work() begins and ends recordings and returns at once otherwise, but for the time that a file
// takes to be ended. One thread.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/daemon/supervision/daemon_metrics.hpp"
#include "services/records/capture/recorder.hpp"

namespace dyncal::inline programs {

struct RecordingPlan {
  std::filesystem::path folder;
  std::set<std::string> benches; // empty: all that are heard of
  bool runs_only = false;
  recording::RecorderOptions options; // but for path, bench and run
  std::uint64_t max_file_bytes = std::uint64_t{4} << 30U;
};

class BenchRecordings {
public:
  static constexpr std::chrono::seconds end_limit{30};
  static constexpr std::chrono::seconds linger{2}; // behind the word that all results are there
  static constexpr std::chrono::seconds silence_limit{150}; // of a run: nobody conducts it any more

  // `participant` outlives the object. Fails (network) as readers do, (bad_file) when the folder
  // cannot be made.
  [[nodiscard]] static Expected<std::unique_ptr<BenchRecordings>>
  create(bus::Participant& participant, RecordingPlan plan);
  BenchRecordings(const BenchRecordings&) = delete;
  BenchRecordings& operator=(const BenchRecordings&) = delete;

  // Waits up to 100 ms for something to do.
  void work();
  [[nodiscard]] std::vector<RecorderFigures> figures() const;
  // Ends all recordings. Fails (bad_file) with the first that has no end in order.
  Expected<void> stop();

private:
  using Instant = bus::Clock::Instant;

  struct Run {
    std::string name;
    Instant heard;
    std::optional<Instant> ends;    // unless something is still caught up with
    std::optional<Instant> give_up; // at the latest
  };
  struct Bench {
    std::unique_ptr<recording::Recorder> recorder;
    std::string recorded_run;         // empty: what lies between runs
    std::optional<Run> run;           // that goes on
    recording::RecorderStatus before; // sums over recordings that have ended
  };
  struct Readers {
    bus::Reader<wire::SourceDescription> descriptions;
    bus::Reader<wire::Measurement> measurements;
    bus::Reader<wire::ServiceStatus> services;
  };

  BenchRecordings(bus::Participant& participant, RecordingPlan plan)
      : participant_(participant), clock_(bus::system_clock()), plan_(std::move(plan)),
        wake_up_(std::make_shared<bus::WakeUp>()) {}
  void take_messages();
  void take(const wire::Measurement& measurement);
  void take(const wire::ServiceStatus& status);
  [[nodiscard]] bool is_wanted(const std::string& bench) const;
  [[nodiscard]] static bool is_past(const Bench& bench, Instant now);
  void choose_file(const std::string& name, Bench& bench);
  void begin(const std::string& name, Bench& bench, const std::string& run);
  Expected<void> end(const std::string& name, Bench& bench);

  bus::Participant& participant_;
  bus::Clock& clock_;
  RecordingPlan plan_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::optional<Readers> readers_;
  std::map<std::string, Bench> benches_;
  std::set<std::pair<std::string, std::string>> over_; // bench and run: not to be begun again
};

} // namespace dyncal::inline programs
