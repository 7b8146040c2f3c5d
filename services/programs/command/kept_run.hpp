// What is kept of a run while it goes on and when it is over: its folder
// (services/records/run_folder) with results, log and recording (services/records/mcap), and its
// entry in the store (services/records/store).
//
// The folder is made and the disk looked at before the first step; a run that is refused before it
// leaves no folder. A store that cannot be written costs no run: the message says how to add it
// later. Belongs to one thread.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "services/bench/file/bench_file.hpp"
#include "services/bus/bus.hpp"
#include "services/daemon/program/log_file.hpp"
#include "services/programs/command/condition_logger.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/records/run_folder/run_folder.hpp"
#include "services/run/run_keeping.hpp"
#include "services/run/run_progress.hpp"
#include "services/views/report/run_statements.hpp"

namespace dyncal::inline records::recording {
class Recorder;
}

namespace dyncal::inline programs {

// Of the run whose results are kept.
struct KeptRunSetup {
  std::string run;
  bool is_resumed = false;
  ActingPerson conducted_by;
  std::string comment; // may be empty
  std::string sensor;  // that the command names; may be empty
  std::optional<AdcFile> adc_file;
  std::string
      dds; // the name of the participant's implementation, and its domain, for the recording
  int domain = 0;
  std::function<void(const std::string& sentence)> notice; // for a line of its own
};

class KeptRun {
public:
  using RateReader = bus::Reader<wire::SourceStatus>;

  // Fails (bad_file) as RunFolder does, (network) as readers do.
  [[nodiscard]] static Expected<std::unique_ptr<KeptRun>> open(const KeepOptions& options,
                                                               const BenchFile& bench,
                                                               KeptRunSetup setup,
                                                               bus::Participant& participant);
  ~KeptRun();
  KeptRun(const KeptRun&) = delete;
  KeptRun& operator=(const KeptRun&) = delete;

  // Valid as long as the object.
  [[nodiscard]] RunKeeping keeping();
  // For all results from now on.
  void set_check(const DailyCheck& check);
  [[nodiscard]] const RunStatements& statements() const { return stated_; }
  // What the progress line shows, for the log.
  void note(const RunProgress& progress);
  // When the run is over. Fails (bad_file) when the final results cannot be written.
  [[nodiscard]] Expected<void> finish(const RunOutcome& outcome);
  // After everything else, for a database may let wait. REQUIRES: finish() has not failed.
  void add_to_store(const RunOutcome& outcome);
  // The last: whether the recording gives what came live (own_recording.hpp); says what came out.
  // Fails (no_result) where it does not. REQUIRES: finish() has not failed.
  [[nodiscard]] Expected<void> hold_against_recording(const RunOutcome& outcome,
                                                      const std::stop_token& stop);
  // A line into its log.
  void log(const std::string& sentence);
  // Of a run that has excited nothing.
  void discard();
  // Nothing when none is kept.
  [[nodiscard]] std::optional<std::filesystem::path> folder() const;

private:
  // What is kept on the disk.
  struct Disk {
    std::unique_ptr<RunFolder> folder;
    LogFile log;
    RateReader rates;
    std::unique_ptr<recording::Recorder> recorder; // nothing: not recorded
  };

  KeptRun(KeepOptions options, const BenchFile& bench, KeptRunSetup setup, std::optional<Disk> disk,
          bus::Participant& participant);
  Expected<void> check(const RunOutcome& planned);
  [[nodiscard]] RunOutcome completed(RunOutcome so_far) const;
  void note_event(const std::string& sentence);
  void note_conditions();
  void note_kept();
  void note_recording();
  void end_recording();
  void say(const std::string& sentence);

  KeepOptions options_;
  const BenchFile& bench_;
  KeptRunSetup setup_;
  std::optional<Disk> disk_; // nothing: none is kept
  bus::Participant& participant_;
  RunStatements stated_;
  std::vector<LoggedCondition> conditions_before_; // of a run that is resumed
  std::unique_ptr<ConditionLogger> conditions_;    // nothing: none are logged
  std::string last_line_;
  std::size_t noted_results_ = 0;
  bool noted_problem_ = false;
  bool noted_end_of_recording_ = false;
  bool is_recorded_whole_ = false;
};

} // namespace dyncal::inline programs
