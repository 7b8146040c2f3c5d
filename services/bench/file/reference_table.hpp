// A response over frequency as a calibration certificate states it: of the reference transducer, of
// its amplifier. A header line names the columns, then a point a line; lines that begin with # and
// empty ones are passed over. Fields are separated by commas, or by semicolons with decimal commas.
//
//   frequency_hz          needed, as is magnitude
//   level_m_s2            the points of each level are a curve; where no frequency is there twice,
//                         it is no more than said, as without it
//   magnitude             what the channel reads over what is (1.002 reads 0.2 % high), or a
//                         sensitivity or gain
//   phase_rad, phase_deg  of the output against what is measured; left out: 0, and its uncertainty
//                         is not stated
//   delay_s               in place of the phase: -2 pi f delay_s, whatever the sign of phases
//   u_magnitude_rel, u_magnitude_percent, u_magnitude (in its unit), u_phase_rad, u_phase_deg
//                         standard uncertainties of the whole, as is u_delay_s; with U for u:
//                         expanded, k times as large
//   k                     coverage factor of columns U_...
//   degrees_of_freedom    of the whole; empty or "infinite": infinite
//   NAME.u_..., NAME.U_..., NAME.degrees_of_freedom
//                         the same of a contribution (ISO 16063-11, annex A), for example
//                         "transverse motion"
//
// With both, what the named contributions leave of the whole is a contribution without a name.
//
// Fails (bad_file) with "NAME:LINE:COLUMN: ..." on the first thing that is not valid: unknown or
// missing columns, fields that are no numbers, implausible values, contributions larger than the
// whole. Any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/instrument/reference_calibration.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline bench {

struct ReferenceTableSettings {
  bool is_ratio = true; // magnitudes are what is read over what is
  bool phase_is_lag = false;
  std::optional<double> coverage_factor{}; // where no column k states it
};

struct ReferenceTable {
  std::vector<analysis::ReferenceCalibrationPoint> points;
  bool phase_in_rad = false; // so that degrees may have been meant
};

// `name` is for messages.
[[nodiscard]] Expected<ReferenceTable>
parse_reference_table(std::string_view text, const std::string& name,
                      const ReferenceTableSettings& settings = {});

} // namespace dyncal::inline bench
