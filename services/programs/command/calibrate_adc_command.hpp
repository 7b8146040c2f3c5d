// `dyncal calibrate adc BENCH.toml`: the response of the DAU's sync ADC over frequency and test
// amplitude, in the path that calibrations use (data-ready edge, stamp, conversion), against the
// ACS's sync channel; analysis/instrument/adc_comparison.hpp has the model.
//
// Conducts one run of the bench's excitation list for each test amplitude, with sync itself as
// reference and as channel under calibration, and writes all measurements as a file that
// `[corrections] adc` reads. Without --amplitudes the bench's levels are used and the test
// amplitude is the one that the ACS finds. With them the generator is set to half of the
// peak-to-peak voltage, so sync must be its output. Needs both sources to stamp in UTC: anything
// else is refused, for an ADC's delay cannot be distinguished from an unknown offset of two
// clocks. An oscilloscope's record is refused as well: it is placed in time by its trigger, which
// the DAU does not stamp. Belongs to one thread.
#pragma once

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "services/bench/file/bench_file.hpp"
#include "services/daemon/program/program.hpp"

namespace dyncal::inline programs {

struct CalibrateAdcCommand {
  std::filesystem::path bench_file;
  std::filesystem::path output = "adc.json";
  std::string channel = "ADC1";       // its name in the file
  std::vector<double> amplitudes_vpp; // empty: one pass with the bench's levels
  double u_time_scale_s = 100e-9;     // of the two sources' stamps against each other
  double u_acs_gain_rel = 0.0;        // of the ACS's sync channel
  NetworkOptions network;
};

[[nodiscard]] int run_calibrate_adc(const CalibrateAdcCommand& command,
                                    const std::stop_token& stop);

// What a bench must be for this calibration, and the bench file of one pass of it. Fail
// (bad_argument) with what is wrong and why.
[[nodiscard]] Expected<void> check_bench_for_adc(const BenchFile& bench, bool sets_amplitude);
[[nodiscard]] BenchFile bench_of_adc_pass(const BenchFile& bench,
                                          std::optional<double> amplitude_vpp);

} // namespace dyncal::inline programs
