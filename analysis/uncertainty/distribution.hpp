// The distributions an input of an uncertainty budget may have (JCGM 101, 6.4).
//
// `standard_uncertainty` turns the half-width of an interval into a standard deviation:
//
//   normal       half_width / 2 (the interval covers 95.45 %)
//   rectangular  half_width / sqrt(3)
//   triangular   half_width / sqrt(6)
//   arcsine      half_width / sqrt(2)
//
// Any thread.
#pragma once

#include <optional>
#include <string_view>

namespace dyncal::analysis {

enum class Distribution { normal, rectangular, triangular, arcsine };

[[nodiscard]] std::string_view to_string(Distribution distribution);
[[nodiscard]] std::optional<Distribution> parse_distribution(std::string_view text);

[[nodiscard]] double standard_uncertainty(Distribution distribution, double half_width);

} // namespace dyncal::analysis
