// Writes the calibration of a DAU's sync ADC in the form that services/bench/file/adc_file.hpp
// reads, with the level "MeataData" (the spelling of the format) and one row for each measurement:
//
//   {"MeataData": {"BordID": n, "Date": "...", ...}, "FitResults": {"ADC1": {"100.0": [{"Freq": Hz,
//   "Amplitude": gain, "Phase": rad lag,
//                                                  "TestAmplVPP.": V, "u_Amplitude": gain,
//                                                  "u_Phase": rad}, ...]}}}
//
// u_Amplitude and u_Phase are the standard uncertainties that all measurements of a frequency have
// in common (u_ fields of the points); programs that do not know them pass over them. Fails
// (bad_file) when the file cannot be written. Any thread.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "analysis/instrument/adc_calibration.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline bench {

struct AdcFileHead {
  std::string channel;   // "ADC1"
  std::uint32_t board{}; // upper half of the ids of the unit's sensors, as an id
  std::string date;      // "2026-01-31 12:00:00", UTC
  std::map<std::string, std::string> remarks; // further entries of "MeataData"
};

[[nodiscard]] Expected<void>
write_adc_file(const std::filesystem::path& path, const AdcFileHead& head,
               std::span<const analysis::AdcCalibrationPoint> measurements);

} // namespace dyncal::inline bench
