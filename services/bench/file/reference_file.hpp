// Reads what is known of the reference of a bench, or of another channel: a table of its response
// alone (CSV, reference_table.hpp), or its certificate as well (TOML):
//
//   [reference]            its certificate (calibrated_device.hpp); documents take it from here
//   [response]             left out: its channel reads right, as that of an interferometer does
//   unit = "pC/(m/s^2)"    of the magnitudes (sensitivity_unit.hpp); "1": what the channel reads
//                          over what is
//   k = 2                  coverage factor of columns U_...
//   phase_sign = "lead"    or "lag"
//   rows = """..."""       the table, or file = "table.csv" from the folder of this file
//   notes = ["..."]        what the certificate says of single values
//   [amplifier]            where the transducer has one: its certificate, and
//   [amplifier.response]   its gain over frequency, with the keys of [response]
//   [channel]              sensitivity and unit by which the reference's system divides its voltage
//                          (measuring_chain.hpp), unless the response has unit "1"
//
// Fails (bad_file) with file, line and key or column on the first problem. Any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/instrument/reference_calibration.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/contract/reference_standard.hpp"

namespace dyncal::inline bench {

struct ReferenceFile {
  std::vector<analysis::ReferenceCalibrationPoint> response; // empty: it reads right
  ReferenceStandard standard;     // without devices where the file is a table alone
  std::vector<std::string> notes; // of the certificate, on single values
  bool phase_in_rad = false;      // as stated, so that degrees may have been meant
  std::string channel_unit{};     // "10.2 mV/(m/s^2)" of [channel]; empty without
};

// `name` as the bench file has it; further files are resolved from its folder.
[[nodiscard]] Expected<ReferenceFile> read_reference_file(const std::string& name,
                                                          NamedFiles& files);

// One in TOML from its text.
[[nodiscard]] Expected<ReferenceFile>
parse_reference_file(std::string_view text, const std::string& name, NamedFiles& files);

} // namespace dyncal::inline bench
