// The bit timing that a virtual CAN interface lacks: one frame at a time, each as long as its bits
// last, the lowest id first.
//
// A frame that is ready waits until the bus is idle; of those that are ready then, the one with the
// lowest id begins (arbitration, ISO 11898-1) and is not interrupted. After its end of frame the
// bus is idle again three bits later (intermission). Errors, retransmission and transmitter delay
// are not modelled. Times are seconds of bench time. One thread.
#pragma once

#include <optional>
#include <vector>

#include "drivers/can/bus/can_frame.hpp"
#include "drivers/can/time/frame_duration.hpp"

namespace dyncal::drivers::virtual_bench {

struct SentFrame {
  can::CanFrame frame;
  double ready_s = 0.0;
  double start_s = 0.0; // of the start-of-frame bit
  double end_s = 0.0;   // of the end-of-frame field
};

class CanBus {
public:
  explicit CanBus(const can::BitRates& rates) : rates_(rates) {}

  void offer(const can::CanFrame& frame, double ready_s);

  // The next frame, when it starts before `time_s`. REQUIRES: whatever is ready before that time
  // has been offered.
  [[nodiscard]] std::optional<SentFrame> next_before(double time_s);

private:
  struct Waiting {
    can::CanFrame frame;
    double ready_s;
  };

  can::BitRates rates_;
  std::vector<Waiting> waiting_;
  double idle_from_s_ = 0.0;
};

} // namespace dyncal::drivers::virtual_bench
