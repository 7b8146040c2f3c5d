// A result file (result.schema.json) read back whole, for documents that are made of it: values
// with U and k, single results with their budgets, losses and flags, and the SHA-256 of the file.
//
// What documents state as numbers is checked key by key here; what they only describe (devices,
// corrections, sample clock) is read from `json` where it is shown, by CheckedJson. Phase is lead
// in rad; NaN: null in the file.
//
// Fails (bad_file) when the file does not exist, is not JSON, has another schema, lacks a key, or
// states no value; the sentence names file and key. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "services/base/error.hpp"
#include "services/views/report/checked_json.hpp"

namespace dyncal::services {

struct StoredUncertainty {
  double u = 0.0; // k = 1
  double k = 2.0;
  double expanded = 0.0; // U
};

struct StoredValue { // a mean over repetitions
  std::string channel;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0; // as planned
  double magnitude = 0.0;
  StoredUncertainty of_magnitude;
  double phase_rad = 0.0; // within (-pi, pi]
  double unwrapped_phase_rad = 0.0;
  StoredUncertainty of_phase; // rad
  double coverage_probability = 0.0;
  std::string unit;
  unsigned repetitions = 0;
  std::vector<std::string> flags; // sentences
  std::vector<std::string> flag_names;
};

struct StoredContribution {
  std::string name;
  std::string distribution;
  std::string repeats;
  double degrees_of_freedom = 0.0; // NaN: infinite
  double u_magnitude_rel = 0.0;
  double u_phase_rad = 0.0;
};

struct StoredPoint { // one repetition
  std::string channel;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  unsigned step = 0;
  unsigned repetition = 0;
  bool valid = false;
  std::string problem; // why it is not valid
  double magnitude = 0.0;
  double u_magnitude = 0.0;
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
  double measured_frequency_hz = 0.0; // NaN: not known, like those below
  double measured_level_m_s2 = 0.0;
  double temperature_degc = 0.0;
  double residual_rel = 0.0; // of the fit of the channel, over its amplitude
  bool has_monte_carlo = false;
  std::uint64_t lost = 0;
  std::string data_sha256;
  std::vector<StoredContribution> budget;
  std::vector<std::string> flag_names;
};

struct StoredChannel {
  std::string channel;
  std::string unit;
  bool responds = false;
  std::uint64_t lost = 0;
  std::vector<std::string> flag_names;
};

struct StoredFlag {
  std::string name;
  std::vector<std::string> sentences;
  std::string meaning;
};

struct StoredResult {
  std::filesystem::path file;
  std::string sha256; // of the file
  std::string bench;
  std::string run;
  std::string method;
  std::string began_utc; // empty: not known
  std::string ended_utc;
  std::string software;
  std::string problem;
  bool interrupted = false;
  unsigned planned_steps = 0;
  std::string recipe_sha256;
  std::vector<StoredFlag> flags;
  std::vector<StoredChannel> channels;
  std::vector<StoredValue> values;
  std::vector<StoredPoint> points;
  std::shared_ptr<const nlohmann::json> json; // the whole file

  [[nodiscard]] CheckedJson root() const { return {*json, ""}; }
  [[nodiscard]] std::vector<StoredValue> values_of(const std::string& channel) const;
  [[nodiscard]] std::vector<StoredPoint> points_of(const std::string& channel) const;
};

// The result file of a run: result.json in a run folder; a file is that file itself.
[[nodiscard]] std::filesystem::path result_file_of(const std::filesystem::path& run);

[[nodiscard]] Expected<StoredResult> read_stored_result(const std::filesystem::path& run);

// A whole file; fails (bad_file) with its name and the reason, and for more than `max_bytes`.
[[nodiscard]] Expected<std::string> read_whole_file(const std::filesystem::path& path,
                                                    std::uintmax_t max_bytes);

} // namespace dyncal::services
