// What daemons of dyncal report of themselves, as metrics: dyncal_ names, labels `bench` and
// `source`. deploy/monitoring/README.md lists them for people. Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "services/contract/program_identity.hpp"

namespace dyncal::wire {
class SourceStatus;
}

namespace dyncal::inline daemon {

class MetricStore;

// Messages of a source that the analysis has left out, since it was started.
struct LeftOutFigures {
  std::string bench;
  std::string source;
  std::uint64_t duplicates = 0;
  std::uint64_t of_other_programs = 0; // in the name of the source
};

// What the analysis service does, all in all.
struct AnalysisFigures {
  std::uint64_t runs_waiting = 0;
  std::uint64_t runs_armed = 0;
  std::uint64_t runs_refused = 0; // of those that are kept
  std::uint64_t runs_finished = 0;
  double evaluation_s = 0.0; // that its loop has spent with runs
  std::uint64_t benches = 0; // that it knows
  std::uint64_t sources = 0;
  std::uint64_t runs_of_others = 0;                            // that it follows
  std::vector<std::pair<std::string, std::uint64_t>> left_out; // had no room, by what it was
  std::vector<LeftOutFigures> left_out_of_sources;
  std::uint64_t malformed_messages = 0;
  std::uint64_t refused_packets = 0;
};

// What a recorder has of one bench, since it was started.
struct RecorderFigures {
  std::string bench;
  std::uint64_t stored = 0;     // messages that are in its files
  std::uint64_t not_stored = 0; // messages that came and are not
  std::uint64_t missing = 0;    // blocks and records that never came
  std::uint64_t file_bytes = 0; // of the file it writes
  std::uint64_t free_bytes = 0; // on the disk
  bool records = false;
};

// What a guard does for one bench, since it was started.
struct GuardFigures {
  std::string bench;
  std::uint64_t switched_off = 0; // times that it has switched the output off
  bool may_be_on = false;         // the output, which nobody attends and it cannot switch off
};

// What dyncal-web does.
struct WebFigures {
  int visitors = 0; // that listen to events now
  std::uint64_t requests = 0;
  std::vector<std::pair<std::string, std::uint64_t>> refused; // by reason
  std::uint64_t benches = 0;                                  // that are shown
  std::uint64_t left_out = 0;                                 // messages that had no room
  std::uint64_t samples_missed = 0;                           // of signals that were looked at
};

void report(const ProgramIdentity& program, MetricStore& store);
void report(const wire::SourceStatus& status, std::uint64_t messages_written, MetricStore& store);
void report(const AnalysisFigures& figures, MetricStore& store);
void report(const RecorderFigures& figures, MetricStore& store);
void report(const GuardFigures& figures, MetricStore& store);
void report(const WebFigures& figures, MetricStore& store);
void report_malformed_messages(std::uint64_t count, MetricStore& store);
void report_refused_packets(std::uint64_t count, MetricStore& store);

} // namespace dyncal::inline daemon
