// Frames of a sound device as values: little-endian integers as parts of full scale, -1 to 1, or
// floating-point numbers, which are taken as they are.
//
//   value = integer / 2^(bits - 1)         24 bits lie in three bytes, or in the low ones of four
//
// Plain functions, any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dyncal::drivers::alsa {

enum class SampleFormat { s16, s24, s24_3le, s32, float32 };

[[nodiscard]] std::size_t bytes_of(SampleFormat format);
// A step of the converter in parts of full scale; 0: floating-point numbers do not tell.
[[nodiscard]] double resolution_of(SampleFormat format);

// Channel after channel, as in a block, each multiplied by its scale. REQUIRES: whole frames of
// `scale.size()` channels.
[[nodiscard]] std::vector<double> values_of(std::span<const std::byte> frames, SampleFormat format,
                                            std::span<const double> scale);

} // namespace dyncal::drivers::alsa
