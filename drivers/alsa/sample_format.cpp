#include "drivers/alsa/sample_format.hpp"

#include <bit>
#include <cstdint>
#include <cstring>

namespace dyncal::drivers::alsa {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are read as they are");

constexpr double full_scale_16 = 32768.0;
constexpr double full_scale_24 = 8388608.0;
constexpr double full_scale_32 = 2147483648.0;

template <class T>
T load(const std::byte* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

// The lower three bytes of four, which end there in the file or not.
double value_of_24(const std::byte* bytes) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, bytes, 3);
  return static_cast<double>(static_cast<std::int32_t>(bits << 8U) >> 8) / full_scale_24;
}

double value_of(const std::byte* bytes, SampleFormat format) {
  switch (format) {
  case SampleFormat::s16:
    return load<std::int16_t>(bytes) / full_scale_16;
  case SampleFormat::s24:
  case SampleFormat::s24_3le:
    return value_of_24(bytes);
  case SampleFormat::s32:
    return load<std::int32_t>(bytes) / full_scale_32;
  case SampleFormat::float32:
    break;
  }
  return static_cast<double>(load<float>(bytes));
}

} // namespace

std::size_t bytes_of(SampleFormat format) {
  switch (format) {
  case SampleFormat::s16:
    return 2;
  case SampleFormat::s24_3le:
    return 3;
  case SampleFormat::s24:
  case SampleFormat::s32:
  case SampleFormat::float32:
    break;
  }
  return 4;
}

double resolution_of(SampleFormat format) {
  switch (format) {
  case SampleFormat::s16:
    return 1.0 / full_scale_16;
  case SampleFormat::s24:
  case SampleFormat::s24_3le:
    return 1.0 / full_scale_24;
  case SampleFormat::s32:
    return 1.0 / full_scale_32;
  case SampleFormat::float32:
    break;
  }
  return 0.0;
}

std::vector<double> values_of(std::span<const std::byte> frames, SampleFormat format,
                              std::span<const double> scale) {
  const std::size_t width = bytes_of(format);
  const std::size_t samples = frames.size() / (width * scale.size());
  std::vector<double> values(samples * scale.size());
  const std::byte* bytes = frames.data();
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t channel = 0; channel < scale.size(); ++channel, bytes += width) {
      values[channel * samples + i] = value_of(bytes, format) * scale[channel];
    }
  }
  return values;
}

} // namespace dyncal::drivers::alsa
