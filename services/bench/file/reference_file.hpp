// Reads the calibration of the reference transducer: CSV, a header line with the names of the
// columns, then a point a line; lines that begin with # and empty ones are passed over.
//
//   frequency_hz          needed, as are magnitude and phase_rad
//   level_m_s2            the points of each level are a curve; without it they hold at every level
//   magnitude             what the reference's channel reads over what is: 1.002 reads 0.2 % high
//   phase_rad             phase of the reading, as lead
//   u_magnitude_rel, u_phase_rad     standard uncertainties of the whole
//   degrees_of_freedom    of the whole; empty or "infinite": infinite
//   NAME.u_magnitude_rel, NAME.u_phase_rad, NAME.degrees_of_freedom
//                         the same of a contribution, for example "transverse motion"
//
// With both, what the named contributions leave of the whole is a contribution without a name.
//
// Fails (bad_file) with "FILE:LINE:COLUMN: ..." on the first thing that is not valid: unknown or
// missing columns, fields that are no numbers, implausible values, contributions larger than the
// whole. Any thread.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "analysis/instrument/reference_calibration.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline bench {

[[nodiscard]] Expected<std::vector<analysis::ReferenceCalibrationPoint>>
read_reference_file(const std::filesystem::path& path);

// The same from text; `name` is for messages.
[[nodiscard]] Expected<std::vector<analysis::ReferenceCalibrationPoint>>
parse_reference_file(std::string_view text, const std::string& name);

} // namespace dyncal::inline bench
