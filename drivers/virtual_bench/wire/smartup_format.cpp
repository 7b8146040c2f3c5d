#include "drivers/virtual_bench/wire/smartup_format.hpp"

#include <bit>
#include <utility>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::size_t full_datagram = 873;
constexpr std::int64_t second_ns = 1'000'000'000;

enum WireType : std::uint32_t { varint = 0, length_delimited = 2, fixed32 = 5 };
enum DescriptionType {
  physical_quantity = 0,
  unit = 1,
  resolution = 3,
  min_scale = 4,
  max_scale = 5,
  hierarchy = 6
};

void put_varint(std::string& out, std::uint64_t value) {
  while (value >= 0x80U) {
    out.push_back(static_cast<char>((value & 0x7fU) | 0x80U));
    value >>= 7U;
  }
  out.push_back(static_cast<char>(value));
}

void put_key(std::string& out, std::uint32_t field, WireType type) {
  put_varint(out, (field << 3U) | type);
}

void put_number(std::string& out, std::uint32_t field, std::uint64_t value) {
  put_key(out, field, varint);
  put_varint(out, value);
}

void put_float(std::string& out, std::uint32_t field, float value) {
  put_key(out, field, fixed32);
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (std::uint32_t shift = 0; shift < 32; shift += 8) {
    out.push_back(static_cast<char>((bits >> shift) & 0xffU));
  }
}

void put_text(std::string& out, std::uint32_t field, const std::string& text) {
  put_key(out, field, length_delimited);
  put_varint(out, text.size());
  out += text;
}

std::string with_length(const std::string& message) {
  std::string out;
  put_varint(out, message.size());
  return out + message;
}

} // namespace

std::optional<std::string> SmartUpPacker::append(const UnitSample& sample) {
  std::string message;
  put_number(message, 1, sensor_id_);
  put_number(message, 2, sample.sample_number);
  put_number(message, 3, static_cast<std::uint64_t>(sample.utc_ns / second_ns));
  put_number(message, 4, static_cast<std::uint64_t>(sample.utc_ns % second_ns));
  put_number(message, 5, sample.uncertainty_ns);
  for (std::uint32_t i = 0; i < unit_channels; ++i) {
    if (sample.data[i]) {
      put_float(message, 6 + i, *sample.data[i]);
    }
  }
  if (with_ticks_) {
    put_number(message, 22, sample.ticks);
  }
  if (datagram_.empty()) {
    datagram_ = "DATA";
  }
  datagram_ += with_length(message);
  if (datagram_.size() < full_datagram) {
    return std::nullopt;
  }
  return std::exchange(datagram_, {});
}

std::string SmartUpPacker::description_head(int type) const {
  std::string message;
  put_number(message, 1, sensor_id_);
  put_text(message, 2, sensor_name_);
  put_number(message, 3, static_cast<std::uint64_t>(type));
  return message;
}

std::string SmartUpPacker::text_description(int type,
                                            const std::vector<UnitChannel>& channels) const {
  std::string message = description_head(type);
  for (const UnitChannel& channel : channels) {
    if (channel.declared) {
      const std::string& text = type == physical_quantity ? channel.quantity
                                : type == unit            ? channel.unit
                                                          : channel.hierarchy;
      put_text(message, 4 + static_cast<std::uint32_t>(channel.index), text);
    }
  }
  if (with_ticks_) {
    put_number(message, 36, 1);
  }
  return "DSCP" + with_length(message);
}

std::string SmartUpPacker::number_description(int type,
                                              const std::vector<UnitChannel>& channels) const {
  std::string message = description_head(type);
  for (const UnitChannel& channel : channels) {
    if (channel.declared) {
      const double number = type == resolution  ? channel.steps
                            : type == min_scale ? channel.minimum
                                                : channel.maximum;
      put_float(message, 20 + static_cast<std::uint32_t>(channel.index),
                static_cast<float>(number));
    }
  }
  if (with_ticks_) {
    put_number(message, 36, 1);
  }
  return "DSCP" + with_length(message);
}

std::vector<std::string>
SmartUpPacker::descriptions(const std::vector<UnitChannel>& channels) const {
  return {text_description(physical_quantity, channels), text_description(unit, channels),
          number_description(resolution, channels),      number_description(min_scale, channels),
          number_description(max_scale, channels),       text_description(hierarchy, channels)};
}

} // namespace dyncal::drivers::virtual_bench
