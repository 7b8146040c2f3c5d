// What every sampling driver hands on: a description of the source and blocks of time-stamped
// samples.
//
// Times are int64 nanoseconds since 1970-01-01 UTC in the source's own time base (see TimeBase),
// never a double. A block holds consecutive sample numbers; a lost sample ends the block, so the
// gap shows between `first_sample + sample_count()` of one block and `first_sample` of the next.
// Values are channel after channel (column major): values[channel * sample_count() + sample].
// Plain data: any thread may own one, none may share one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/quadrature_signals.hpp"

namespace dyncal::drivers {

enum class TimeBase { local, utc };
enum class StampInstant {
  unknown,
  data_ready_edge,
  conversion,
  trigger_edge,
  frame_start,
  frame_end
};

struct ChannelDescription {
  std::string name;     // as roles name it after the slash: "acceleration_z", "sync"
  std::string quantity; // physical quantity in words, "" if not known
  std::string unit;     // D-SI, e.g. \metre\second\tothe{-2}
  double minimum = 0.0; // of the range, in the unit; minimum == maximum: not known
  double maximum = 0.0;
  double resolution = 0.0; // one quantisation step in the unit; 0: not known
  bool operator==(const ChannelDescription&) const = default;
};

struct SourceDescription {
  std::string device;
  std::string serial;
  std::string firmware{}; // "": not known
  std::string driver;
  std::vector<ChannelDescription> channels; // in the order of the columns of a block
  double nominal_rate_hz = 0.0;             // 0: not known
  TimeBase time_base = TimeBase::local;
  StampInstant stamp_instant = StampInstant::unknown;
  double tick_s = 0.0; // quantum of the stamps; 0: not known
  double stamp_uncertainty_s =
      0.0; // standard uncertainty of one stamp in its time base; 0: not known
  std::vector<QuadratureSignals> quadrature_signals{}; // of the channels that are made of such
  bool operator==(const SourceDescription&) const = default;
};

// Bits of SampleBlock::flags, one byte a sample. 0 means the stamp is trusted.
enum StampFlag : std::uint8_t {
  stamp_second_slip = 1U << 0U,       // a whole second early or late
  stamp_counter_extension = 1U << 1U, // 2^32 ticks off
  stamp_torn_counter = 1U << 2U, // 2^16 ticks off: halves of the counter read at different times
  stamp_offset_below_second = 1U << 3U, // jumped by less than a second, e.g. an extra PPS edge
  stamp_repeated = 1U << 4U,            // same time as the sample before
  stamp_no_uncertainty = 1U << 5U,      // the unit says 0: it does not trust its clock
  stamp_no_fix = 1U << 6U,              // the unit has no time yet (unix time 0)
  stamp_backwards = 1U << 7U            // earlier than the sample before for another reason
};

// The stamp of sample number n of a source with a regular clock is
//   origin_ns + round_half_up(n * interval_numerator_ns / interval_denominator), exact for every n.
struct RegularClock {
  std::int64_t origin_ns = 0;
  std::int64_t interval_numerator_ns = 0;
  std::int64_t interval_denominator = 1;

  [[nodiscard]] std::int64_t stamp_ns(std::uint64_t sample) const {
    __extension__ using Wide = __int128; // 64 bits do not hold sample * numerator for long records
    const Wide scaled =
        static_cast<Wide>(sample) * interval_numerator_ns * 2 + interval_denominator;
    return origin_ns +
           static_cast<std::int64_t>(scaled / (2 * static_cast<Wide>(interval_denominator)));
  }
};

struct SampleBlock {
  std::uint64_t first_sample = 0;
  std::size_t samples = 0;
  std::optional<RegularClock> clock;   // set: stamps follow from it, and stamps_ns is empty
  std::vector<std::int64_t> stamps_ns; // one per sample otherwise
  std::vector<std::uint32_t> stamp_uncertainty_ns; // standard uncertainty, one per sample, or empty
  std::vector<std::uint8_t> flags;  // StampFlag bits, one per sample, or empty: all trusted
  std::vector<double> values;       // NaN: the device did not measure this channel for this sample
  std::int64_t received_utc_ns = 0; // host clock when the last sample of the block arrived
};

} // namespace dyncal::drivers
