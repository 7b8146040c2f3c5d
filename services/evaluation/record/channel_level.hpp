// Amplitude and phase of a sine of known frequency in part of a channel's record (three-parameter
// approximation, analysis/sine/sine_fit.hpp), in the unit of the channel: for what is decided while
// a step is excited, without uncertainty. A displacement that is made of quadrature signals is
// taken without the slow motion of the table, as the acceleration at that frequency, in m/s^2.
//
// Plain functions, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::inline evaluation {

// How many seconds of samples show the amplitude at this frequency: four periods, 0.2 s at least.
[[nodiscard]] double level_window_s(double frequency_hz);

struct ChannelPart {
  std::span<const std::int64_t> stamps_ns; // of the record
  std::vector<double> values;
};
// Empty where the record has no such column.
[[nodiscard]] ChannelPart part_of(const SourceRecord& record, std::size_t channel,
                                  const TimeInterval& interval,
                                  const analysis::Frequency& frequency);

struct SineOfPart {
  double amplitude = 0.0;
  double phase_rad = 0.0; // lead, at
  std::int64_t at_ns = 0; // its first sample
};

// Nothing where the interval holds fewer than 16 samples, the record has no such column, or a value
// is not finite.
[[nodiscard]] std::optional<SineOfPart> sine_in(const SourceRecord& record, std::size_t channel,
                                                const TimeInterval& interval,
                                                const analysis::Frequency& frequency);
// Its amplitude.
[[nodiscard]] std::optional<double> level_in(const SourceRecord& record, std::size_t channel,
                                             const TimeInterval& interval,
                                             const analysis::Frequency& frequency);

} // namespace dyncal::inline evaluation
