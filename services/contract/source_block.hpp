// One block of samples where it lies, in a message of the bus or in a driver's block, without a
// copy of its arrays.
//
// A view: anyone who looks at it must have done so before the message or block changes. Values are
// channel after channel, values[channel * samples + sample]; times are int64 nanoseconds in the
// time base of the source. Plain data; any thread may own one, none may share one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/sample_block.hpp"

namespace dyncal::wire {
class SampleBlock;
}

namespace dyncal::inline contract {

struct SourceBlock {
  std::uint64_t session = 0;
  std::uint64_t number = 0; // of the block in its session
  std::uint64_t first_sample = 0;
  std::size_t samples = 0;
  std::size_t channels = 0;
  bool end_of_stream = false;
  drivers::RegularClock clock; // where stamps_ns is empty
  std::span<const std::int64_t> stamps_ns{};
  std::span<const std::uint32_t> stamp_uncertainty_ns{};
  std::span<const std::uint8_t> flags{};
  std::span<const double> values{};

  // Whether the sizes of its arrays agree with each other and its clock runs.
  [[nodiscard]] bool is_consistent() const;
  // REQUIRES: is_consistent(), samples > 0
  [[nodiscard]] std::int64_t first_stamp_ns() const {
    return stamps_ns.empty() ? clock.stamp_ns(first_sample) : stamps_ns.front();
  }
  [[nodiscard]] std::int64_t last_stamp_ns() const {
    return stamps_ns.empty() ? clock.stamp_ns(first_sample + samples - 1) : stamps_ns.back();
  }
};

[[nodiscard]] SourceBlock view_block(const wire::SampleBlock& message);
// A driver's block carries neither session nor number nor the end of the stream.
[[nodiscard]] SourceBlock view_block(const drivers::SampleBlock& block, std::uint64_t session,
                                     std::uint64_t number);

} // namespace dyncal::inline contract
