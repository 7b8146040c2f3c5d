// Reads the calibration file of a DAU's sync ADC, as the SmartUp Unit's calibration program writes
// it (JSON):
//
//   {"MeataData": {...}, "FitResults": {"ADC1": {"100.0": [{"Freq": Hz, "Amplitude": gain, "Phase":
//   rad, "TestAmplVPP.": V}, ...]}}}
//
// Three variants are met and accepted: this one, the same without the levels "MeataData" and
// "FitResults", and a file of one ADC without the ADC's level. "Phase" is positive for a lag in
// most files; older ones have the other sign, so the bench file says it. `dyncal calibrate adc`
// adds "u_Amplitude" and "u_Phase" to a measurement (services/bench/file/adc_file_writer.hpp):
// standard uncertainties of what all measurements of a frequency have in common; other files have
// none. Several measurements of a frequency become one point with the uncertainty of their mean
// (analysis/instrument/adc_calibration.hpp); test amplitudes are never mixed: one is returned, the
// nearest to the one asked for. Fails (bad_file), one sentence with file, channel and what is
// wrong: missing or no JSON, the channel is not in it, values that are not numbers or not possible,
// several test amplitudes and none chosen, none within a factor of two.
#pragma once

#include <vector>

#include "analysis/instrument/adc_calibration.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline bench {

[[nodiscard]] Expected<std::vector<analysis::AdcCalibrationPoint>>
read_adc_file(const AdcCorrectionSettings& settings);

// Of the file that the bench file names; no points where it names none.
[[nodiscard]] Expected<std::vector<analysis::AdcCalibrationPoint>>
read_adc_calibration(const BenchFile& bench);

} // namespace dyncal::inline bench
