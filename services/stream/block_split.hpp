// Long blocks of samples as several short ones: the same samples, the same bits.
//
// An instrument may send a second of samples in one frame. As one message that would be megabytes
// to repair when a packet is lost, and what holds blocks by number would hold gigabytes. Plain
// function, any thread.
#pragma once

#include <cstddef>
#include <vector>

#include "drivers/sample_block.hpp"

namespace dyncal::inline stream {

// Of the arrays of a block; a message is little longer.
inline constexpr std::size_t max_block_bytes = std::size_t{64} << 10U;

// In a secured laboratory: a message is one packet of an Ethernet, encrypted. Messages are not cut
// but by IP there, and of a longer one the whole is lost with each of its packets
// (decisions/25-secured-blocks.md).
inline constexpr std::size_t max_secured_block_bytes = 1000;

// Blocks of at most `max_bytes`, but of one sample at least, in order. A block that is short enough
// comes back as it is.
[[nodiscard]] std::vector<drivers::SampleBlock> split(drivers::SampleBlock block,
                                                      std::size_t max_bytes = max_block_bytes);

} // namespace dyncal::inline stream
