// A line in a record in which nothing is excited, where the record shows that it lasts: hum does,
// an exciter that rings down does not.
//
// The record is divided into four blocks. Their amplitudes must agree with their mean within half
// of it, their uncertainty included (2 u), and show no slope: less than 10 % over the record, or
// less than three times its own uncertainty. So a decay of a time constant below some three records
// is told from hum while it stands out of the noise; what does not stand out of it, or is not told,
// is not said to last. The blocks must add up to 0.8 of their amplitudes: what leaks into them from
// a decay at another frequency does not, while hum may be 0.3 of a turn a record off the frequency
// that is asked for.
//
//   a e^{i phi}   least squares with a constant, over the whole record
//
// Nothing where a block holds fewer than two periods or 16 samples, where the line is below 4.5 u,
// or where it is not shown to last. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "analysis/sine/unresolved_lines.hpp"

namespace dyncal::analysis {

// `seen_hz`: where sampling puts it (folded_hz()); the stamps are those of the record.
[[nodiscard]] std::optional<LineAmplitude>
measure_stationary_line(double line_hz, double seen_hz, std::span<const std::int64_t> stamps_ns,
                        std::span<const double> values);

} // namespace dyncal::analysis
