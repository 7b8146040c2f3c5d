// What a recording holds of one run: its plan, its sources, where every message of them is, and
// what the live analysis said about it.
//
// A first walk through the file. Messages of a source are put in the order of their sessions and
// numbers, wherever they stand: what a source gave again stands behind what came later. Sessions
// are in the order in which the first message of each stands in the file, which no clock sets:
// anyone who was given a session again was given its beginning before that of the next one. Fails
// (bad_file) when the file cannot be read, holds no run, or several and none is named; what is
// damaged in it is listed. Plain data afterwards; any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/evaluation/result/clock_report.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records {

// Where a message is in the file.
struct RecordedPlace {
  std::uint64_t chunk = 0;
  std::uint64_t position = 0;
  // When the source sent it first, by the recorder's clock; what was given again was recorded
  // later. How far the two clocks are apart the message tells that was recorded soonest, of those
  // of its session.
  std::int64_t sent_ns = 0;
};

// A message within its source: session by its place in time, block or shot.
struct RecordedPosition {
  std::size_t session = 0;
  std::uint64_t number = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): a zero that the compiler puts in
  auto operator<=>(const RecordedPosition&) const = default;
};

struct RecordedSource {
  std::map<std::uint64_t, wire::SourceDescription> descriptions; // the newest of each session
  std::optional<wire::SourceDescription> newest;
  std::vector<std::uint64_t> sessions; // in the order in which they began
  std::map<RecordedPosition, RecordedPlace> messages;
  std::set<std::string> answered; // runs
  bool triggered = false;         // TriggeredRecords, else SampleBlocks

  // REQUIRES: a session of its messages.
  [[nodiscard]] RecordedPosition position(std::uint64_t session, std::uint64_t number) const;
};

struct RecordedRunIndex {
  wire::Measurement plan; // as it came first
  wire::Measurement newest;
  std::optional<wire::Excitation> first_announced;
  std::uint64_t began = 0;                       // log_time of state RUNNING; 0: not heard
  std::uint64_t ended = 0;                       // log_time of the state behind it; 0: not heard
  std::map<std::string, RecordedSource> sources; // of the bench
  std::optional<wire::ServiceStatus> analysis;   // of the live run, the newest
  std::optional<BlockPosition> clock_end;        // of its clock report
  std::uint64_t live_results = 0;
  std::vector<RunPause> pauses; // while it ran, the conductor gave a reason why it waited
  recording::ScanReport report; // of the file
};

// Everything of a recording, whether it holds a run or not.
struct RecordingContents {
  std::map<std::string, RecordedRunIndex> runs; // by name, without sources and report
  std::map<std::pair<std::string, std::string>, RecordedSource> sources; // by bench and name
  recording::ScanReport report;
};

// `count`: of the file's megabytes. Both fail (interrupted) if a stop was requested meanwhile.
[[nodiscard]] Expected<RecordingContents> index_contents(recording::RecordingReader& reader,
                                                         const SharedWorkCount& count = nullptr,
                                                         const std::stop_token& stop = {});

// `run`: empty where the recording holds one.
[[nodiscard]] Expected<RecordedRunIndex> index_recording(recording::RecordingReader& reader,
                                                         const std::string& run,
                                                         const SharedWorkCount& count = nullptr,
                                                         const std::stop_token& stop = {});

} // namespace dyncal::inline records
