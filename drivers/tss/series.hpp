// One series of a sensor that records by itself after a trigger, as it comes from the device: over
// a socket or as a file (drivers/tss/README.md).
//
// The instants of the samples are unknown; the device promises a nominal rate and counts its
// triggers (`shot`). Values are in the channel's unit, channel after channel:
//
//   values[channel * samples + sample]
//
// Fails: malformed, with what is wrong. Plain data; the parsers are pure functions: any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::tss {

struct Series {
  std::string device;
  std::string serial;
  std::string firmware;
  std::uint64_t shot = 0;
  double nominal_rate_hz = 0.0;
  double first_sample_s = 0.0; // traces in files: after the trigger, negative before it
  std::size_t samples = 0;
  std::vector<ChannelDescription> channels;
  std::vector<double> values;
  std::int64_t received_utc_ns = 0; // host clock when it was complete
};

enum class ValueForm { int16, int32, float32, float64 };

// The line before the bytes: everything but the values.
struct SeriesHeader {
  Series series; // without values
  ValueForm form = ValueForm::float64;
  std::vector<double> scales; // unit per count, one per channel

  [[nodiscard]] std::size_t bytes() const; // of all values
};

[[nodiscard]] Expected<SeriesHeader> parse_series_header(std::string_view json_line);

// Values of sample after sample, each with all channels, little endian. Fails when the size is not
// header.bytes() or a value is not finite.
[[nodiscard]] Expected<Series> decode_series(SeriesHeader header, std::span<const char> bytes);

// The CSV form: "# key = value" lines, a line of channel names, one line a sample.
[[nodiscard]] Expected<Series> parse_series_csv(std::string_view text);

} // namespace dyncal::drivers::tss
