// The ellipse of a record from the record itself: moments, a first ellipse, the turns of phase that
// it shows, then the fit that these turns ask for (ellipse_fit.hpp, which also says what is
// refused).
//
// With the ellipse comes how the radius changes with the phase, for a step whose own arc is too
// short to show it: both come from the same record. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/interferometer/ellipse_fit.hpp"
#include "analysis/interferometer/quadrature_phase.hpp"

namespace dyncal::analysis {

struct RecordEllipse {
  EllipseFit fit;
  std::optional<RadiusHarmonics> radius; // empty: the arc was too short
};

[[nodiscard]] Expected<RecordEllipse> ellipse_of_record(std::span<const std::int16_t> u1,
                                                        std::span<const std::int16_t> u2);
[[nodiscard]] Expected<RecordEllipse> ellipse_of_record(std::span<const float> u1,
                                                        std::span<const float> u2);
[[nodiscard]] Expected<RecordEllipse> ellipse_of_record(std::span<const double> u1,
                                                        std::span<const double> u2);

} // namespace dyncal::analysis
