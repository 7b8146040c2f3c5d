// One record of an instrument that records after a trigger: a trace of the oscilloscope, or a
// series of the sensor.
//
// `first_sample_s` counts from the instrument's trigger point, seconds; sample n was taken
// n * interval_s later. Values are channel after channel. Plain data; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dyncal::wire {
class TriggeredRecord;
}

namespace dyncal::inline contract {

struct TriggeredRecord {
  std::uint64_t session = 0;
  std::uint64_t shot = 0;    // number of the trigger in its session
  std::uint32_t step = 0;    // of the run
  std::uint32_t attempt = 1; // the excitation of this step that it was taken in
  std::size_t samples = 0;
  std::size_t channels = 0;
  std::int64_t trigger_utc_ns = 0;
  double first_sample_s = 0.0;
  double interval_s = 0.0;
  std::vector<double> values{};

  // REQUIRES: channel < channels
  [[nodiscard]] std::span<const double> channel(std::size_t channel) const {
    return std::span(values).subspan(channel * samples, samples);
  }
};

[[nodiscard]] TriggeredRecord from_message(const wire::TriggeredRecord& message);

} // namespace dyncal::inline contract
