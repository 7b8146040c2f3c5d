// Keeps the result.json of a run up to date while it goes on: a thread of its own writes the newest
// state whole (services/base), so that anyone who conducts the run never waits for the disk.
//
// Bound: one state is held besides the one that is being written. Policy when another comes: it
// takes its place, since it holds all of it. A state that could not be written is reported by
// problem(), and written with the next one.
//
// The file of a run that has not ended says so in "problem"; its means over repetitions are of what
// there is. Any thread.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/run_statements.hpp"

namespace dyncal::inline records {

class ResultKeeper {
public:
  explicit ResultKeeper(std::filesystem::path path);
  ~ResultKeeper();
  ResultKeeper(const ResultKeeper&) = delete;
  ResultKeeper& operator=(const ResultKeeper&) = delete;

  // Into all files from now on.
  void set_statements(RunStatements stated);
  // Before the first step, by the caller's thread. Fails (bad_file) when it cannot be written.
  [[nodiscard]] Expected<void> begin(RunOutcome planned);
  // The state of a run that goes on.
  void keep(RunOutcome so_far);
  // How many results the file on the disk has.
  [[nodiscard]] std::size_t results_kept() const;
  // Why the newest state is not on the disk; nothing if it is, or is being written.
  [[nodiscard]] std::optional<Error> problem() const;
  // Ends the thread; then the final state is written. Fails (bad_file) when it cannot be, with
  // where the results are instead (services/views/report/show_outcome.hpp).
  [[nodiscard]] Expected<void> finish(const RunOutcome& outcome);
  void stop();

private:
  void write_newest(const std::stop_token& stop);
  [[nodiscard]] Expected<void> write(const RunOutcome& state);
  [[nodiscard]] RunStatements statements() const;

  const std::filesystem::path path_;
  std::mutex writing_; // of the file; taken before the other where both are
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<RunOutcome> newest_; // not yet written
  RunStatements stated_;
  std::size_t results_kept_ = 0;
  std::optional<Error> problem_;
  std::jthread thread_; // the last member: it ends before what it uses
};

} // namespace dyncal::inline records
