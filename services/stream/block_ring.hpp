// The buffer between the thread that serves a device and the thread that publishes: write() on the
// bus may block for seconds, the device's thread never may.
//
// Bounds: the time between the oldest and the newest entry when they were put in (for a live
// device: the duration of its data), and the bytes held. Policy when full: the newest entry is not
// taken and is counted; what is already held stays whole, so the gap shows once, as a jump of
// `first_sample`.
//
// Entries keep their order; each belongs to a session and holds a block of samples, the record of
// one shot, or the mark that ends the stream. Any number of threads put in, one thread takes out.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::inline stream {

struct RingLimits {
  std::chrono::nanoseconds span = std::chrono::seconds(60);
  std::size_t bytes = std::size_t{256} << 20U;
};

// What a record that was triggered has besides its samples.
struct Shot {
  std::uint64_t number = 0; // of the session, from 1; both records of a shot have the same
  std::string run;
  std::uint32_t step = 0;
  std::uint32_t attempt = 1;       // the excitation of the step
  std::int64_t trigger_utc_ns = 0; // of the host's clock
  double first_sample_s = 0.0;     // from the trigger to the first sample
  double interval_s = 0.0;
};

struct RingEntry {
  drivers::SampleBlock block; // of a shot: its values alone
  std::optional<Shot> shot;   // of a triggered source
  std::uint64_t session = 0;
  bool end_of_stream = false; // no samples; the last entry of its session
  std::chrono::steady_clock::time_point offered{};
};

// Memory that a block holds, as the ring counts it.
[[nodiscard]] std::size_t held_bytes(const drivers::SampleBlock& block);

// What is lost with an entry: its samples, or one shot.
[[nodiscard]] std::uint64_t size_of(const RingEntry& entry);

class BlockRing {
public:
  explicit BlockRing(RingLimits limits) : limits_(limits) {}

  // Returns false if the ring is full: the entry is lost and counted in dropped(). Never blocks. A
  // mark without samples is always taken.
  bool offer(RingEntry entry);

  // Waits for room. Returns false if `stop` was requested before there was any: the entry is lost
  // and not counted.
  bool offer_waiting(RingEntry entry, const std::stop_token& stop);
  // Waits for room, but only so long; then the entry is lost and counted, and those after it do not
  // wait until there is room again.
  bool offer_within(RingEntry entry, std::chrono::nanoseconds limit, const std::stop_token& stop);

  [[nodiscard]] std::optional<RingEntry> take();
  // Waits for an entry. Nothing if `stop` was requested before there was one.
  [[nodiscard]] std::optional<RingEntry> take_waiting(const std::stop_token& stop);

  // Throws away the samples that are held, but no mark: nobody wants them any more. Not counted.
  void discard();

  [[nodiscard]] bool empty() const;
  [[nodiscard]] double fill() const;           // 0 empty ... 1 full, the fuller of the two bounds
  [[nodiscard]] std::uint64_t dropped() const; // samples, or shots

private:
  [[nodiscard]] bool has_room(const RingEntry& entry) const;
  void append(RingEntry entry, std::unique_lock<std::mutex> lock);
  std::optional<RingEntry> take_oldest(std::unique_lock<std::mutex> lock);

  const RingLimits limits_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<RingEntry> entries_;
  std::size_t bytes_ = 0;
  std::uint64_t dropped_ = 0;
  bool waited_in_vain_ = false; // for room, and there was none since
};

} // namespace dyncal::inline stream
