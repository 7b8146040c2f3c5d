// How long before a record its sine began, from the samples before it:
//
//   t = 2 / A integral (y - C) sin(w (t - t_0) + theta) dt      up to the first stamp of the record
//
// the time that the sine, at the amplitude A of the record, would have taken for what they hold.
// Where in the edge this lies depends on its shape and on the phase there, which two records of one
// excitation share: the difference of their onsets is the offset of their clocks, the delay of one
// behind the other included. What the square of the sine adds at the end of the integral is taken
// out.
//
// u: noise as large as the residuals of the record, half the longest interval of the samples, a
// millisecond, and a 25th of a period: what an offset or another line does at an edge, a phase
// there that the other record has not, and what the two channels make of a transient.
//
// Empty where samples are missing or exceed three amplitudes: something else happened there.
// REQUIRES: stamps that rise, before the record's first; as many values. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

// From where nothing was excited to the first stamp of the record.
struct RisingSine {
  std::span<const std::int64_t> stamps_ns{};
  std::span<const double> values{};
};

struct SineOnset {
  double before_s = 0.0; // before the first stamp of the record
  double u_s = 0.0;
};

// `fit` about `phase_origin_ns`, of the record that begins at `first_ns`.
[[nodiscard]] std::optional<SineOnset> sine_onset(const Frequency& frequency,
                                                  std::int64_t phase_origin_ns, const SineFit& fit,
                                                  const RisingSine& rise, std::int64_t first_ns);

} // namespace dyncal::analysis
