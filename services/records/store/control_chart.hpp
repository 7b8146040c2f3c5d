// Is a bench in control? A check sensor is measured again and again on it; its first n complete
// results give the limits that the later ones are held against.
//
//   lines       |H| (relative) and arg H of every point that all first n results have, of channels
//               that respond; and of every channel with several such points the mean change of |H|
//               and the change of delay over all of them, in which a drift of the whole channel
//               shows long before it does in single points
//   centre, s   mean of the first n results, and how much single results scatter among them
//   limits      centre +- k s sqrt(1 + 1/n); k of Student's t with n - 1 degrees of freedom, so
//               that all lines together leave the warning limit as rarely as one normal value
//               leaves 2 s (4.55 %), and the action limit as rarely as 3 s (0.27 %): few results
//               and many points do not alarm for nothing
//   given       limits of |H| and arg H that somebody states take their place, warnings at two
//               thirds; there are no lines of whole channels then
//
// What is left out is named: a point that not all first results have, that the newest lacks, or
// that has a flag which forbids a certificate, in the newest result then a warning. Another
// evaluation of a run counts once. Results of other benches, which have another reference, are not
// looked at. Plain functions, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "services/records/store/store.hpp"

namespace dyncal::inline records {

enum class CheckState { in_control, warning, action, too_few };
[[nodiscard]] std::string to_string(CheckState state); // "in control"

enum class ControlQuantity { magnitude, phase, mean_magnitude, delay };

struct ControlOptions {
  static constexpr std::size_t least_first = 3;

  std::size_t first = 10;
  std::string bench{};                         // empty: that of the newest result
  std::string since_utc{};                     // results before it are left out; empty: none is
  std::optional<double> limit_magnitude_rel{}; // given action limits
  std::optional<double> limit_phase_rad{};
};

struct ControlValue {
  std::size_t calibration = 0; // index into ControlChart::calibrations
  double deviation = 0.0;      // from the centre: relative, rad, or s
  CheckState state = CheckState::in_control;
};

struct ControlLine {
  PointIdentity point; // of a whole channel: its channel alone
  std::string frequency_text_hz;
  ControlQuantity quantity = ControlQuantity::magnitude;
  double centre = 0.0;  // |H| or rad; 0 of a whole channel
  double s = 0.0;       // of one result
  double warning = 0.0; // half widths
  double action = 0.0;
  std::vector<ControlValue> values{};   // by time
  std::optional<ControlValue> newest{}; // nothing: the newest result has none
};

struct ControlChart {
  std::string bench{};
  std::vector<Calibration> calibrations{}; // by time
  std::vector<std::size_t> first{};        // which of them the limits are of
  std::vector<ControlLine> lines{};
  std::vector<std::string> notes{};
  CheckState state = CheckState::too_few; // of the newest
};

[[nodiscard]] ControlChart control_chart_of(std::vector<Calibration> calibrations,
                                            const ControlOptions& options);

} // namespace dyncal::inline records
