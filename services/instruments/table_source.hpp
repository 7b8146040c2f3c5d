// One source of a bench file whose driver is "table", from its settings to its publisher: hands out
// the steps that a system has evaluated itself, row by row of the table that it writes.
//
// It answers to a run like any source, and sends a block without samples every second, by which the
// run sees that it is there. What is of a run, TableWatch says; it goes on after the run, for late
// rows, until the next one begins. A service that is started in the middle of a run hands out
// nothing of it: which rows stood there before, nobody knows any more. A table that cannot be read
// or does not fit the plan is the status's message until that has changed.
//
// Threads: prepare() from one thread; run() in a thread of the source's own.
#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>

#include "services/base/error.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/instruments/table_watch.hpp"
#include "services/stream/source_publisher.hpp"

namespace dyncal::inline instruments {

class TableSource {
public:
  // Fails (bad_file) with a table that is none. One that is not there yet is to come.
  [[nodiscard]] static Expected<TableSource> prepare(const SourceSettings& settings);

  // Until `stop`.
  [[nodiscard]] Expected<void> run(SourcePublisher& publisher, const std::stop_token& stop);

private:
  using Instant = TableWatch::Instant;

  explicit TableSource(SourceSettings settings) : settings_(std::move(settings)) {}
  void turn(SourcePublisher& publisher, Instant now);
  void begin(SourcePublisher& publisher, const HeardRun& run, Instant now);
  void look(SourcePublisher& publisher, bool run_is_over, Instant now);
  void say(SourcePublisher& publisher, std::string problem);

  SourceSettings settings_;
  std::string run_; // that is watched, or was passed over
  std::optional<TableWatch> watch_;
  std::string said_;    // of the run, for the status
  std::string problem_; // as the status has it
  Instant shown_{};     // when the last block was sent
};

} // namespace dyncal::inline instruments
