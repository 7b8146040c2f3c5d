#include "drivers/files/tdms/strided_values.hpp"

#include <algorithm>

namespace dyncal::drivers::files {
namespace {

template <class Stored>
void copy_as(const char* from, const ValueStretch& stretch, std::span<double> to) {
  const std::uint64_t stride = stretch.stride;
  if (stretch.bit >= 0) {
    for (std::size_t i = 0; i < to.size(); ++i, from += stride) {
      to[i] = (static_cast<unsigned char>(*from) >> static_cast<unsigned>(stretch.bit)) & 1U;
    }
  } else if (stretch.big_endian) {
    for (std::size_t i = 0; i < to.size(); ++i, from += stride) {
      to[i] = static_cast<double>(tdms_number_at<Stored>(from, true));
    }
  } else if (stride == sizeof(Stored)) { // a loop of its own: it is that of most files
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = static_cast<double>(tdms_number_at<Stored>(from + i * sizeof(Stored), false));
    }
  } else {
    for (std::size_t i = 0; i < to.size(); ++i, from += stride) {
      to[i] = static_cast<double>(tdms_number_at<Stored>(from, false));
    }
  }
}

void copy(const char* from, const ValueStretch& stretch, std::span<double> to) {
  switch (stretch.type) {
  case TdmsType::i8:
    return copy_as<std::int8_t>(from, stretch, to);
  case TdmsType::i16:
    return copy_as<std::int16_t>(from, stretch, to);
  case TdmsType::i32:
    return copy_as<std::int32_t>(from, stretch, to);
  case TdmsType::i64:
    return copy_as<std::int64_t>(from, stretch, to);
  case TdmsType::u8:
  case TdmsType::boolean:
    return copy_as<std::uint8_t>(from, stretch, to);
  case TdmsType::u16:
    return copy_as<std::uint16_t>(from, stretch, to);
  case TdmsType::u32:
    return copy_as<std::uint32_t>(from, stretch, to);
  case TdmsType::u64:
    return copy_as<std::uint64_t>(from, stretch, to);
  case TdmsType::f32:
  case TdmsType::f32_with_unit:
    return copy_as<float>(from, stretch, to);
  default:
    return copy_as<double>(from, stretch, to);
  }
}

} // namespace

void StridedValues::read(std::span<double> to) {
  while (!to.empty()) {
    const ValueStretch& stretch = stretches_[stretch_];
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), stretch.values - value_));
    copy(file_.data() + stretch.place + chunk_ * stretch.chunk_bytes + value_ * stretch.stride,
         stretch, to.first(count));
    to = to.subspan(count);
    value_ += count;
    if (value_ == stretch.values) {
      value_ = 0;
      ++chunk_;
    }
    if (chunk_ == stretch.chunks) {
      chunk_ = 0;
      ++stretch_;
    }
  }
}

} // namespace dyncal::drivers::files
