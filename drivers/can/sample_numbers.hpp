// The numbers of a sensor's samples, so that every lost one shows as a gap.
//
// They follow the counter or time field (key) where there is one, and then a gap has just the size
// of the loss; otherwise arrival, with gaps by the nominal rate where it is known and by the frames
// that the socket has dropped. After an interruption of the link there is a gap of at least one
// sample where the key does not tell how many were missed. One thread; does not fail.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/can/sensor_layout.hpp"

namespace dyncal::drivers::can {

class SampleNumbers {
public:
  void begin_session() { last_.reset(); }
  void frames_were_dropped(std::uint64_t frames) { frames_dropped_ += frames; }
  void was_interrupted() { interrupted_ = true; }

  // Of the sample whose first frame the kernel stamped then; the first of a session has 0. `key`
  // counts where the layout has keys.
  [[nodiscard]] std::uint64_t next(const SensorLayout& layout, std::int64_t key,
                                   std::int64_t kernel_ns);
  // How many are missing before the newest.
  [[nodiscard]] std::uint64_t lost_before() const { return lost_before_; }

private:
  struct Last {
    std::uint64_t number = 0;
    std::int64_t key = 0;
    std::int64_t kernel_ns = 0;
  };

  [[nodiscard]] std::uint64_t step_by_key(const SensorLayout& layout, std::int64_t key) const;
  [[nodiscard]] std::uint64_t step_by_arrival(const SensorLayout& layout,
                                              std::int64_t kernel_ns) const;

  std::optional<Last> last_;
  std::uint64_t frames_dropped_ = 0; // since the last sample
  bool interrupted_ = false;         // since then
  std::uint64_t lost_before_ = 0;
};

} // namespace dyncal::drivers::can
