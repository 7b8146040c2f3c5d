// Joins the frames that make up one sample by what they carry (a counter or a time field), never by
// when they came.
//
// A sample of one message is complete with its frame. A sample of several is complete when each
// message has come once with the same key. Up to `max_open` samples may be open at a time, since
// frames of neighbouring samples may overtake each other; the oldest is given up, and counted, when
// one more begins. Samples leave in the order in which their keys first came. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "drivers/can/bus/can_frame.hpp"

namespace dyncal::drivers::can {

struct JoinedSample {
  std::uint64_t key = 0;                       // raw counter or time field
  std::vector<std::optional<CanFrame>> frames; // one a message, all there
};

struct JoinCounts {
  std::uint64_t incomplete = 0; // samples given up because a frame of theirs did not come
  std::uint64_t repeated = 0;   // frames of a message that their sample had already
};

class SampleJoiner {
public:
  static constexpr std::size_t max_open = 4;

  explicit SampleJoiner(std::size_t messages) : messages_(messages) {}

  // `message` counts from 0; `key` is not looked at when there is one message only.
  [[nodiscard]] std::optional<JoinedSample> add(std::size_t message, std::uint64_t key,
                                                const CanFrame& frame);
  // What is open will not be completed: frames were lost.
  void give_up_open();

  [[nodiscard]] const JoinCounts& counts() const { return counts_; }

private:
  [[nodiscard]] bool recently_left(std::uint64_t key) const;

  std::size_t messages_;
  std::deque<JoinedSample> open_;
  std::deque<std::uint64_t> left_; // keys of the last samples that left, complete or not
  JoinCounts counts_;
};

} // namespace dyncal::drivers::can
