// Puts the frames of a virtual bus on a CAN interface of this host at the instants at which they
// have ended on the bus.
//
// A virtual interface has no bit timing: what is written to it arrives, and is stamped, at once. So
// each frame is written when the host's clock (CLOCK_REALTIME) shows the end of its end-of-frame
// field. The thread sleeps until shortly before and polls the clock for the rest; where permitted,
// it runs with real-time priority.
//
// Frames of which only the presence on the bus matters may come some 0.1 ms late and cost the host
// less. A frame of the sensor that the host had no time for is sent late and counted.
//
// put() from one thread; the line has a thread of its own until it is destroyed.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stop_token>
#include <thread>

#include "drivers/can/bus/can_frame.hpp"
#include "drivers/can/bus/frame_sender.hpp"

namespace dyncal::drivers::virtual_bench {

// The calling thread goes before those of ordinary programs (SCHED_RR), where the host lets it:
// instruments do not wait for programs.
void request_realtime_priority(int priority);

class CanLine {
public:
  explicit CanLine(can::FrameSender sender);

  // Frames in the order of their ends. `exact`: one whose stamp matters.
  void put(const can::CanFrame& frame, std::int64_t end_utc_ns, bool exact);

  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t exact() const { return exact_; }
  [[nodiscard]] std::uint64_t late() const {
    return late_;
  } // of the exact ones, by more than 100 us
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

private:
  struct TimedFrame {
    can::CanFrame frame;
    std::int64_t end_utc_ns;
    bool exact;
  };

  void run(const std::stop_token& stop);
  void send(const TimedFrame& timed);
  void sleep_until_watch(std::int64_t end_utc_ns);

  can::FrameSender sender_;
  std::mutex mutex_;
  std::condition_variable_any frame_added_;
  std::deque<TimedFrame> waiting_;
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<std::uint64_t> exact_{0};
  std::atomic<std::uint64_t> late_{0};
  std::atomic<std::uint64_t> refused_{0};
  std::int64_t watch_ns_; // before the end of a frame, when the thread wakes up; its own
  std::jthread thread_;   // last: ends before what it uses
};

} // namespace dyncal::drivers::virtual_bench
