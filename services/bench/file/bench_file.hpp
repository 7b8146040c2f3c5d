// The bench file: one TOML file that describes what a bench consists of, what is excited, how it is
// evaluated, with which corrections and uncertainties. The same file serves the source programs,
// `dyncal run` and `dyncal analyse`.
//
// Whatever is not valid is refused here, with file, line and key: unknown keys (with the nearest
// known one), wrong types, impossible values, units that are not D-SI, roles that name no source, a
// file that a correction needs and that does not exist. Units are in the keys: _s, _hz, _rad, _ns;
// `level` is in m/s^2 (or the reference's unit).
//
// Any thread; a BenchFile is plain data.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/instrument/reference_calibration.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_problem.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/contract/channel_axis.hpp"
#include "services/contract/channel_name.hpp"
#include "services/contract/channel_response.hpp"
#include "services/contract/dut_phase.hpp"
#include "services/contract/evaluation_method.hpp"
#include "services/contract/reference_standard.hpp"
#include "services/contract/transverse_motion.hpp"

namespace dyncal::inline bench {

struct NetworkSettings {
  std::vector<std::string> peers;
  bool multicast = true;
  std::string interface_name;
};

struct MultisineSettings {
  double period_s = 10.0;
  double dropped_periods = 1.0;
};

struct ExcitationSettings {
  std::vector<std::string> frequencies_hz; // decimal text, checked to be a positive number
  std::vector<double> levels_m_s2;         // one per frequency
  std::string axis;                        // excited: "x", ...; empty: not stated
  TransverseMotion transverse_motion;
  int repetitions = 1;
  bool repeat_first = false; // the first step once more at the end
  int attempts = 3; // excitations of a step, until its result is as good as another can make it
  double settling_s = 1.0;
  double duration_s = 3.0;
  // Of the measured level from the planned one, without a flag; left out: what a recipe takes.
  std::optional<double> level_deviation_rel;
  bool settling_from_data = false; // settling_s is the longest that may be left out
  bool whole_record =
      false; // evaluate each record as a whole: one step, nothing searched, nothing left out
  std::optional<MultisineSettings> multisine{}; // all frequencies at once
};

enum class GeneratorDriver { none, by_hand, scpi };

// A program sets it and can switch it off, at an address of the network: what is asked of runs,
// guards and checks.
[[nodiscard]] constexpr bool is_instrument(GeneratorDriver driver) {
  switch (driver) {
  case GeneratorDriver::none:
  case GeneratorDriver::by_hand:
    return false;
  case GeneratorDriver::scpi:
    break;
  }
  return true;
}

struct GeneratorSettings {
  GeneratorDriver driver = GeneratorDriver::none;
  std::string address;
  double level_per_volt = 1.0;               // m/s^2 per V
  std::optional<double> level_tolerance_rel; // closed loop on the reference's amplitude
  std::optional<double> maximum_voltage_v;   // zero to peak
  std::optional<double> maximum_level_m_s2;
  std::optional<double> maximum_velocity_m_s;    // amplitude, as the next
  std::optional<double> maximum_displacement_mm; // half the stroke
};

struct MethodSettings {
  EvaluationMethod kind = EvaluationMethod::sample_timestamping;
  ChannelName reference;
  ChannelName sync_acs;
  ChannelName sync_dau; // series time stamping: the oscilloscope's sync
  int shots = 5;        // series time stamping: per step
  bool trigger_phase_correction =
      true; // series time stamping; false shows what the correction of every shot is worth
  std::vector<ChannelName> dut; // empty: all channels of the DAU but sync and temperature
  std::optional<ChannelName> temperature;
  std::vector<ChannelAxis> axes;      // of channels whose names do not say it
  std::vector<double> mains_hz;       // empty: what a recipe takes
  double frequency_search_rel = 1e-3; // how far the excitation may be from its nominal frequency;
                                      // 0: exactly there in both clocks
  double clock_tolerance_ppm = 200.0; // how right the crystals of ACS and DAU are
  DutPhase dut_phase = DutPhase::delay;
};

enum class PhaseSign { lag, lead };

struct AdcCorrectionSettings {
  std::filesystem::path file;
  std::string channel;
  PhaseSign phase_sign = PhaseSign::lag;
  std::optional<double> test_amplitude_vpp;
};

struct CorrectionSettings {
  std::optional<AdcCorrectionSettings> adc;
  std::vector<analysis::ReferenceCalibrationPoint> reference; // empty: it reads right
  ReferenceStandard reference_standard;     // as its file states it; without devices: it does not
  std::vector<std::string> reference_notes; // of its certificate
  bool reference_phase_in_rad = false;      // as stated, so that degrees may have been meant
  std::vector<ChannelResponse> channel_responses; // by the sources' `sensitivity`
  double reference_delay_s = 0.0; // of the reference's channel against the ACS's sync
  double dso_delay_s = 0.0;       // of the oscilloscope's trigger output
  double u_dso_delay_s = 0.0;
};

// Of the clock of an oscilloscope of which nothing is stated: 25 ppm either way, a rectangle.
inline constexpr double default_dso_rate_rel = 1.44e-5;

struct UncertaintySettings { // standard uncertainties
  double reference_magnitude_rel = 0.0;
  double reference_phase_rad = 0.0;
  double acs_delay_s = 0.0;
  std::uint64_t monte_carlo_trials = 0; // at most, for the cross-check of every result; 0: none
  double acs_rate_rel = 0.0;            // of the ACS's clock, for sample rates
  double dso_rate_rel = default_dso_rate_rel;
  double adc_delay_s = 0.0; // of a sync ADC without calibration; 0: not stated
};

struct BenchFile {
  std::filesystem::path path;
  std::string text;
  std::string sha256;
  std::string bench;
  std::string sensor{}; // under calibration: its serial number in the library; may be empty
  NetworkSettings network;
  ExcitationSettings excitation;
  GeneratorSettings generator;
  std::vector<SourceSettings> sources;
  MethodSettings method;
  CorrectionSettings corrections;
  UncertaintySettings uncertainty;
  std::vector<NamedFile> named_files;

  [[nodiscard]] const SourceSettings* source(const std::string& name) const;
};

// Fails (bad_file) with one sentence that begins "FILE:LINE: key 'table.key' ...". `place`: where
// the files are that it names.
[[nodiscard]] Expected<BenchFile>
read_bench_file(const std::filesystem::path& path,
                NamedFiles::Place place = NamedFiles::Place::as_named);

// The same from text that did not come from a file; `path` is for messages and as the folder of
// relative paths.
[[nodiscard]] Expected<BenchFile>
parse_bench_file(const std::string& text, const std::filesystem::path& path,
                 NamedFiles::Place place = NamedFiles::Place::as_named);

// The same two with everything that is not valid, in the order of the tables; where there is a
// problem, `file` holds what could be read.
struct BenchFileReading {
  BenchFile file;
  BenchProblems problems;
};

[[nodiscard]] BenchFileReading
read_whole_bench_file(const std::filesystem::path& path,
                      NamedFiles::Place place = NamedFiles::Place::as_named);
[[nodiscard]] BenchFileReading
parse_whole_bench_file(const std::string& text, const std::filesystem::path& path,
                       NamedFiles::Place place = NamedFiles::Place::as_named);

} // namespace dyncal::inline bench
