// Logs the surroundings of a run ([conditions] of the bench file) while it goes on: a reading of
// each source at once, then every `every_s`, and a last one at the end.
//
// Readings come from channels of sources (the mean of the samples that come within two seconds),
// from the newest line of the file of a data logger, or from what a command prints. One that is
// older than `max_age_s`, of the future, in another unit, or beyond what there is on earth is none:
// sentences say so, and that it is read again, and the result has the reason. Channels may be in K
// and Pa as well. Every reading goes into conditions.csv of the run folder.
//
// Reads in a thread of its own, which may wait for a command for 10 s; the conductor never waits
// but in finish(). The other functions: one thread.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/conditions_table.hpp"
#include "services/bus/bus.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/run_statements.hpp"
#include "services/views/signals/signal_tap.hpp"

namespace dyncal::inline programs {

// One reading, or why there is none. Nothing: no new one.
struct ConditionReading {
  std::int64_t utc_ns = 0;
  double value = 0.0;
};
using ReadCondition = std::function<Expected<ConditionReading>()>;

// Over the run, of one source. Not thread-safe.
class ConditionSummary {
public:
  ConditionSummary(const ConditionSettings& settings, const ConditionQuantity& quantity);

  // A sentence where readings begin to be missing, or come again; "": nothing is new.
  [[nodiscard]] std::string take(const Expected<ConditionReading>& reading, std::int64_t now_ns);
  [[nodiscard]] const LoggedCondition& logged() const { return logged_; }
  // Whether take() has added a reading to those before; the newest.
  [[nodiscard]] std::optional<ConditionReading> newest() const { return newest_; }

private:
  [[nodiscard]] std::string what_is_wrong(const Expected<ConditionReading>& reading,
                                          std::int64_t now_ns) const;

  double max_age_s_;
  LoggedCondition logged_;
  std::optional<ConditionReading> newest_;
  bool is_missing_ = false;
};

class ConditionLogger {
public:
  // Of a run whose sources have described themselves. `participant` outlives it.
  ConditionLogger(ConditionSettings settings, const BenchFile& bench, const RunOutcome& planned,
                  bus::Participant& participant, std::filesystem::path csv);
  ~ConditionLogger();
  ConditionLogger(const ConditionLogger&) = delete;
  ConditionLogger& operator=(const ConditionLogger&) = delete;

  // Since the last call, for log and journal.
  [[nodiscard]] std::vector<std::string> take_sentences();
  [[nodiscard]] std::vector<LoggedCondition> logged() const;
  // Reads once more, and ends.
  [[nodiscard]] std::vector<LoggedCondition> finish();

private:
  ReadCondition reader_of(const ConditionQuantity& quantity, const BenchFile& bench,
                          const RunOutcome& planned);
  ReadCondition channel_reader(const ConditionQuantity& quantity, const std::string& bench,
                               const RunOutcome& planned);
  [[nodiscard]] Expected<double> mean_since(const TappedChannel& channel,
                                            bus::Clock::Instant since);
  void gather_samples();
  void run(const std::stop_token& stop);
  void read_all();
  void keep(const ConditionSummary& summary);

  const ConditionSettings settings_;
  bus::Participant& participant_;
  const std::filesystem::path csv_;
  std::unique_ptr<SignalTap> tap_;     // where a source is a channel
  bus::Clock::Instant looked_since_{}; // of the thread
  std::vector<ReadCondition> readers_;
  mutable std::mutex mutex_; // of what follows
  std::vector<ConditionSummary> summaries_;
  std::vector<std::string> sentences_;
  std::condition_variable_any ended_;
  std::jthread thread_; // the last: it ends before what it uses
};

// Of a run that was resumed: what it logged before and since.
[[nodiscard]] std::vector<LoggedCondition>
joined_conditions(const std::vector<LoggedCondition>& before,
                  const std::vector<LoggedCondition>& since);

} // namespace dyncal::inline programs
