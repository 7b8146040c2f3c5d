// Puts a recording back on DDS, in its own time or faster.
//
// What is put back says so: descriptions of sources name the file as their driver, states and runs
// carry it in their message, the conductor of a run is "replay of FILE". A bench that is live in
// the domain is refused (no_source): nobody shall take recorded samples for live ones; give another
// name of the bench, or another domain. Commands and requests are not put back, nor are the states
// of guards, which a run would rely on; results and the states of analyses only with `results`:
// without them an analysis service evaluates the run again.
//
// Samples are written so that readers keep up: with speed 0 as fast as they take them. Fails
// (bad_file) with what is wrong with the file, (network) as writers do. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records {

struct ReplayOptions {
  std::filesystem::path recording;
  std::string bench;  // empty: as recorded
  double speed = 1.0; // multiple of real time; 0: as fast as possible
  bool results = true;
};

struct ReplayFigures {
  std::uint64_t written = 0;
  std::uint64_t not_written = 0; // the network did not take them
  std::uint64_t left_out = 0;    // commands, requests, guards, results that are not wanted
  recording::ScanReport report;  // of the file
};

class RecordingPlayer {
public:
  // Looks at the file, and listens whether the bench is live. `participant` outlives the object.
  [[nodiscard]] static Expected<RecordingPlayer>
  open(bus::Participant& participant, ReplayOptions wish, const std::stop_token& stop);

  [[nodiscard]] const std::string& bench() const { return wish_.bench; }
  [[nodiscard]] Expected<ReplayFigures> play(const std::stop_token& stop);

private:
  RecordingPlayer(bus::Participant& participant, ReplayOptions wish,
                  recording::RecordingReader reader)
      : participant_(&participant), wish_(std::move(wish)), reader_(std::move(reader)) {}

  bus::Participant* participant_;
  ReplayOptions wish_;
  recording::RecordingReader reader_;
};

} // namespace dyncal::inline records
