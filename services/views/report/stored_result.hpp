// A result file (result.schema.json) read back whole: values with U and k, single results with
// their budgets, losses and flags, what was measured with, and the SHA-256 of the file.
//
// read_result() is the only reader of result files. It holds them against the schema that is
// installed, so that all commands refuse the same file with the same sentence, which names file and
// key. Members that it does not know are ignored: later versions add some. Phase is lead in rad;
// NaN: null in the file.
//
// Fails (bad_file) when the file does not exist, is not JSON, has another schema or version,
// deviates from it, or has single results but no transfer function of them; read_values() also when
// the run has no value at all, as one has that was ended early. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/base/byte_count.hpp"
#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/expanded_uncertainty.hpp"
#include "services/views/report/run_journal.hpp"
#include "services/views/report/run_statements.hpp"

namespace dyncal::inline views {

// Raised with every change of the schema beyond new keys, which readers ignore.
inline constexpr int result_schema_version = 2;

struct StoredValue { // a mean over repetitions
  std::string channel;
  std::string unit;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;    // as planned
  std::string excited_axis{}; // empty: not stated
  double magnitude = 0.0;
  ExpandedUncertainty of_magnitude;
  double phase_rad = 0.0;       // within (-pi, pi]
  ExpandedUncertainty of_phase; // rad
  double unwrapped_phase_rad = 0.0;
  double scatter_magnitude = 0.0; // standard deviation of one repetition
  double scatter_phase_rad = 0.0;
  unsigned repetitions = 0;
  double coverage_probability = 0.0;
  double u_independent_phase_rad = 0.0; // U / 2 without what repeats
  std::vector<std::string> flags;       // sentences
  std::vector<std::string> flag_names;
};

struct StoredFit {
  analysis::ChannelFit fit;
  std::string role; // of the channel; empty: not known
};

// One repetition. Read back, it has no fits, and of the Monte Carlo check what was stated.
struct StoredPoint : StepResult {
  std::vector<std::string> sentences; // of its flags
  std::vector<std::string> flag_names;
  ExpandedUncertainty of_magnitude;
  ExpandedUncertainty of_phase;
  double measured_frequency_hz = nan_value; // NaN: not known, as those below
  double u_measured_frequency_hz = nan_value;
  double measured_level_m_s2 = nan_value;
  double u_measured_level_m_s2 = nan_value;
  std::optional<StoredFit> own_fit;
};

struct StoredChannel {
  std::string channel;
  std::string unit;
  bool responds = false;
  std::uint64_t lost = 0;
  std::vector<std::string> flags; // sentences
  std::vector<std::string> flag_names;
  std::optional<std::string> group_delay_problem;
  std::vector<Closure> closures{};
};

struct StoredDelay {
  std::string channel;
  analysis::GroupDelay delay;
};

struct StoredFlag {
  std::string name;                   // "samples_lost"
  std::vector<std::string> sentences; // as the results carry them, each once: "dau: samples lost"
  std::string meaning;                // and what to do
};

struct StoredRoles { // "source/channel"; empty: none
  std::string reference;
  std::string excitation;
  std::string sync_acs;
  std::string sync_dau;
  std::string sync_dso;
  std::vector<std::string> dut;
  std::string temperature;
};

struct StoredCorrection { // what one correction does to H at one frequency
  std::string name;
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
  std::optional<double> magnitude_factor;
  std::optional<double> u_magnitude_rel;
};

struct StoredStep { // as planned, and what reference and sync show of it
  unsigned step = 0;
  unsigned repetition = 0;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  double settling_s = 0.0;
  double duration_s = 0.0;
  std::vector<StoredCorrection> corrections;
  std::vector<StoredFit> fits; // not read back
};

struct StoredCorrections { // as the recipe has them for all steps
  double reference_delay_s = 0.0;
  std::optional<ReferenceStandard> reference_standard; // not stated with the run: nothing
  std::vector<ChannelAxis> channel_axes;
  std::optional<TransverseMotion> transverse_motion; // likewise
  std::optional<std::vector<analysis::AdcCalibrationPoint>> adc_calibration;
  std::optional<AdcFile> adc_file; // of adc_calibration
  std::optional<double> dso_delay_s;
  double u_dso_delay_s = 0.0;
  bool trigger_phase_correction = false;
};

struct CombinedRun { // of a result that combines several
  std::string bench;
  std::string run;
  std::string sha256; // of its result file
};

struct StoredResult : RunStatements {
  std::filesystem::path file;
  std::string sha256; // of the file
  std::string bench;
  std::string run;
  std::string method;
  std::string software;
  std::string analysis_software; // empty: not known
  std::string analysis_host;
  std::string analysis_dds; // "none": without a network
  std::string began_utc;    // empty: not known
  std::string ended_utc;
  unsigned planned_steps = 0;
  bool interrupted = false;
  std::string problem;
  std::string recipe_sha256;
  std::vector<StoredFlag> flags;
  std::vector<RunSource> sources;
  std::vector<RunPause> pauses;
  std::optional<StoredRoles> roles;
  std::optional<StoredCorrections> corrections;
  std::vector<StoredStep> steps; // as planned
  std::vector<StoredChannel> channels;
  std::vector<StoredValue> values;
  std::vector<StoredDelay> group_delays;
  std::vector<ClockReport> clocks;
  std::vector<StoredPoint> points;
  std::string recipe;                // text of the bench file
  std::vector<CombinedRun> combined; // the mountings that it combines; empty: it is of one run
  std::vector<JournalEntry> journal; // of the run; not in the file (amendments.hpp)
  std::string content_sha256; // without what another evaluation of the same samples may change

  [[nodiscard]] std::vector<StoredValue> values_of(const std::string& channel) const;
  [[nodiscard]] std::vector<StoredPoint> points_of(const std::string& channel) const;
  [[nodiscard]] std::vector<Closure> closures_of(const std::string& channel) const;
  // "dau/x: phase towards 0 Hz: ..." for each that is open and casts doubt on values.
  [[nodiscard]] std::vector<std::string>
  open_closures(const std::vector<std::string>& channels) const;
  [[nodiscard]] std::vector<StoredPoint> points_of(const std::vector<std::string>& names) const;
  // Null: the channel has none.
  [[nodiscard]] const analysis::GroupDelay* group_delay_of(const std::string& channel) const;
};

// The result file of a run: result.json in a run folder; a file is that file itself.
[[nodiscard]] std::filesystem::path result_file_of(const std::filesystem::path& run);

[[nodiscard]] Expected<StoredResult> read_result(const std::filesystem::path& run);
[[nodiscard]] Expected<StoredResult> read_result(const std::filesystem::path& run,
                                                 ByteCount& count);
[[nodiscard]] Expected<StoredResult> read_values(const std::filesystem::path& run);
[[nodiscard]] Expected<StoredResult> read_values(const std::filesystem::path& run,
                                                 ByteCount& count);
// The text of that file, and what the text of a file of this name holds.
[[nodiscard]] Expected<std::string> read_result_text(const std::filesystem::path& run);
[[nodiscard]] Expected<StoredResult>
result_of_text(const std::string& text, const std::filesystem::path& file, ByteCount& count);

} // namespace dyncal::inline views
