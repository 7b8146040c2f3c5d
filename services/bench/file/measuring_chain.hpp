// What the channel of a reference reads over what is, from what the certificates of its transducer
// and its amplifier state:
//
//   R(f) = S(f) G(f) / C
//
// S: sensitivity of the transducer, G: gain of its amplifier (1 where it has none), C: the
// sensitivity that the reference's system divides its voltage by. Contributions of the amplifier
// are named "amplifier", or "amplifier NAME". Points are those of both tables where both hold; what
// either misses between its own points is the contribution "frequencies of the certificates".
//
// Fails (bad_argument): units that do not fit each other, tables without a frequency in common, a
// chain that reads less than half or more than twice what is. Any thread.
#pragma once

#include <optional>
#include <vector>

#include "analysis/instrument/reference_calibration.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/sensitivity_unit.hpp"

namespace dyncal::inline bench {

struct StatedResponse {
  SensitivityUnit unit;
  std::vector<analysis::ReferenceCalibrationPoint> points; // magnitudes in that unit
};

struct MeasuringChain {
  StatedResponse transducer;
  std::optional<StatedResponse> amplifier;
  SensitivityUnit channel_unit;
  double channel_sensitivity = 1.0;
};

[[nodiscard]] Expected<std::vector<analysis::ReferenceCalibrationPoint>>
response_of(const MeasuringChain& chain);

} // namespace dyncal::inline bench
