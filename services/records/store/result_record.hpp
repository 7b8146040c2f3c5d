// A result file of dyncal as the store keeps it: what identifies it, its sources, its values, and
// the file itself.
//
// `content_sha256` is of the file without what another evaluation of the same samples may change:
// times, software, hosts. Fails (bad_file) when the file cannot be read or is not a result; a run
// folder stands for the result.json in it. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::services {

enum class RunCompletion {
  complete,    // every planned step has a value
  incomplete,  // steps without a value, or a channel
  interrupted, // by the user
  ended_early, // for a reason that the result states
  unfinished   // runs now, or its program ended before it
};
[[nodiscard]] std::string to_string(RunCompletion state);

struct RecordedInstrument {
  std::string source;
  std::string device;
  std::string serial;
  std::string firmware;
  std::string software;
};

struct RecordedPoint { // mean over repetitions; NaN: not known
  std::string source;
  std::string channel;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  std::string unit;
  double magnitude = 0.0;
  double u_magnitude = 0.0;
  double k_magnitude = 0.0;
  double expanded_magnitude = 0.0;
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
  double k_phase = 0.0;
  double expanded_phase_rad = 0.0;
  std::string flags; // names, with commas
};

struct RecordedSamples { // what one value was made from
  std::string channel;
  std::int64_t step = 0;
  std::int64_t repetition = 0;
  std::string sha256;
};

struct ResultRecord {
  std::string result_sha256; // of the file
  std::string content_sha256;
  std::string recipe_sha256;
  std::string bench;
  std::string run;
  RunCompletion state = RunCompletion::complete;
  std::string method;
  std::string began_utc; // "": not known
  std::string ended_utc;
  std::string software;
  std::int64_t planned_steps = 0;
  std::int64_t measured_steps = 0;
  std::string problem;
  std::string recipe;
  std::string folder;   // or file, absolute
  std::string document; // the file
  std::vector<RecordedInstrument> sources;
  std::vector<RecordedPoint> points;
  std::vector<RecordedSamples> samples;
};

[[nodiscard]] Expected<ResultRecord> read_result_record(const std::filesystem::path& path);

} // namespace dyncal::services
