// When the values of a channel of a TDMS file were measured, by the properties of its waveform.
//
//   wf_start_time + wf_start_offset + n * wf_increment
//
// The increment is a double, so 1/51200 s is not exactly what it says: a rate within 1e-9 of a
// whole number is that number, any other increment is its shortest decimal text, exactly. Start and
// offset are rounded to the nanosecond. Plain functions, any thread.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/files/tdms/tdms_property.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::files {

// From 0 on. Nothing unless 1e-9 <= increment <= 1e6.
[[nodiscard]] std::optional<RegularClock> tdms_interval(double increment_s);

// Of the first value; nothing where no time is stated.
[[nodiscard]] std::optional<std::int64_t> tdms_start_ns(const TdmsProperties& channel);

// Whether the stamps of as many samples hold in 64 bits.
[[nodiscard]] bool holds_stamps(const RegularClock& clock, std::uint64_t samples);

} // namespace dyncal::drivers::files
