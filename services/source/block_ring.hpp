// The buffer between the thread that listens to a device and the thread that publishes: write() on
// the bus may block for seconds, the listener never may.
//
// Bounds: the time between the oldest and the newest entry when they were put in (for a live
// device: the duration of its data), and the bytes held. Policy when full: the newest block is not
// taken and its samples are counted; what is already held stays whole, so the gap shows once, as a
// jump of `first_sample`. Entries keep their order; each belongs to a session and may carry marks
// (end of the stream) instead of samples. Any number of threads put in, one thread takes out.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>

#include "drivers/sample_block.hpp"

namespace dyncal::services {

struct RingLimits {
  std::chrono::nanoseconds span = std::chrono::seconds(60);
  std::size_t bytes = std::size_t{256} << 20U;
};

struct RingEntry {
  drivers::SampleBlock block;
  std::uint64_t session = 0;
  bool end_of_stream = false; // no samples; the last entry of its session
  std::chrono::steady_clock::time_point offered{};
};

// Memory that a block holds, as the ring counts it.
[[nodiscard]] std::size_t held_bytes(const drivers::SampleBlock& block);

class BlockRing {
public:
  explicit BlockRing(RingLimits limits) : limits_(limits) {}

  // False when the ring is full: the entry is lost and its samples are counted in
  // dropped_samples(). Never blocks. A mark without samples is always taken.
  bool offer(RingEntry entry);

  // Waits for room. False when `stop` was requested before there was any: the entry is lost and not
  // counted.
  bool offer_waiting(RingEntry entry, const std::stop_token& stop);

  [[nodiscard]] std::optional<RingEntry> take();

  [[nodiscard]] bool empty() const;
  [[nodiscard]] double fill() const; // 0 empty ... 1 full, the fuller of the two bounds
  [[nodiscard]] std::uint64_t dropped_samples() const;

private:
  [[nodiscard]] bool has_room(const RingEntry& entry) const;
  void append(RingEntry entry);

  const RingLimits limits_;
  mutable std::mutex mutex_;
  std::condition_variable_any room_;
  std::deque<RingEntry> entries_;
  std::size_t bytes_ = 0;
  std::uint64_t dropped_samples_ = 0;
};

} // namespace dyncal::services
