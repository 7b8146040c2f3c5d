#include "drivers/smartup/datagram.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "drivers/smartup/wire_reader.hpp"

namespace dyncal::drivers::smartup {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t keyword_bytes = 4;

struct Tag {
  std::uint32_t field = 0;
  WireType type = WireType::varint;
};

bool read_tag(WireReader& reader, Tag& tag) {
  std::uint64_t value = 0;
  if (!reader.varint(value) || value > UINT32_MAX) {
    return false;
  }
  tag = {static_cast<std::uint32_t>(value >> 3U), static_cast<WireType>(value & 7U)};
  return tag.field != 0;
}

// Numbers of 32 bits are sent as varints; more bits than that are cut off, as the format says.
bool read_u32(WireReader& reader, std::uint32_t& value) {
  std::uint64_t wide = 0;
  if (!reader.varint(wide)) {
    return false;
  }
  value = static_cast<std::uint32_t>(wide);
  return true;
}

bool read_float(WireReader& reader, float& value) {
  std::uint32_t bits = 0;
  if (!reader.fixed32(bits)) {
    return false;
  }
  value = std::bit_cast<float>(bits);
  return true;
}

// The unit copies fixed fields of up to 40 characters that may or may not end in a NUL.
std::string text_of(Bytes bytes) {
  const auto end = std::ranges::find(bytes, std::uint8_t{0});
  return {bytes.begin(), end};
}

class DataFields {
public:
  explicit DataFields(DataMessage& message) : message_(message) {}

  // False when the field cannot be read.
  bool read(WireReader& reader, Tag tag) {
    if (tag.type == WireType::varint && tag.field >= 1 && tag.field <= 5) {
      seen_ |= 1U << tag.field;
      return read_u32(reader, header(tag.field));
    }
    if (tag.type == WireType::fixed32 && tag.field >= first_value_field &&
        tag.field < first_value_field + channels_of_unit) {
      const std::uint32_t channel = tag.field - first_value_field;
      message_.present = static_cast<std::uint16_t>(message_.present | (1U << channel));
      return read_float(reader, message_.values[channel]);
    }
    if (tag.type == WireType::varint && tag.field == time_ticks_field) {
      std::uint64_t ticks = 0;
      if (!reader.varint(ticks)) {
        return false;
      }
      message_.time_ticks = ticks;
      return true;
    }
    return reader.skip(tag.type);
  }

  [[nodiscard]] bool complete() const {
    return seen_ == all_required && (message_.present & 1U) != 0;
  }
  [[nodiscard]] RejectedMessage rejected(Rejection cause) const {
    RejectedMessage rejected{.cause = cause, .sensor = {}, .sample_number = {}};
    if ((seen_ & (1U << 1U)) != 0) {
      rejected.sensor = message_.sensor;
    }
    if ((seen_ & (1U << 2U)) != 0) {
      rejected.sample_number = message_.sample_number;
    }
    return rejected;
  }

private:
  static constexpr std::uint32_t first_value_field = 6;
  static constexpr std::uint32_t time_ticks_field = 22;
  static constexpr std::uint32_t all_required =
      0b111110; // fields 1 to 5; Data_01 shows in `present`

  std::uint32_t& header(std::uint32_t field) {
    switch (field) {
    case 1:
      return message_.sensor;
    case 2:
      return message_.sample_number;
    case 3:
      return message_.unix_time_s;
    case 4:
      return message_.nanoseconds;
    default:
      return message_.time_uncertainty_ns;
    }
  }

  DataMessage& message_;
  std::uint32_t seen_ = 0;
};

// Where it stands already: a copy would cost as much as reading it.
void decode_data(Bytes bytes, std::size_t framed_bytes, Datagram& datagram) {
  DataMessage& message = datagram.data.emplace_back();
  message.bytes = static_cast<std::uint16_t>(std::min<std::size_t>(framed_bytes, UINT16_MAX));
  WireReader reader(bytes);
  DataFields fields(message);
  std::optional<Rejection> problem;
  Tag tag;
  while (!reader.at_end() && !problem) {
    if (!read_tag(reader, tag) || !fields.read(reader, tag)) {
      problem = Rejection::malformed;
    }
  }
  if (!problem && !fields.complete()) {
    problem = Rejection::missing_field;
  }
  if (problem) {
    datagram.rejected.push_back(fields.rejected(*problem));
    datagram.data.pop_back();
  }
}

class DescriptionFields {
public:
  bool read(WireReader& reader, Tag tag) {
    if (tag.type == WireType::varint) {
      return read_number(reader, tag);
    }
    if (tag.type == WireType::bytes) {
      Bytes text;
      if (!reader.delimited(text)) {
        return false;
      }
      if (tag.field == name_field) {
        message_.sensor_name = text_of(text);
        has_name_ = true;
      } else if (tag.field >= first_text_field && tag.field < first_text_field + channels_of_unit) {
        message_.texts[tag.field - first_text_field] = text_of(text);
      }
      return true;
    }
    if (tag.type == WireType::fixed32 && tag.field >= first_number_field &&
        tag.field < first_number_field + channels_of_unit) {
      float value = 0.0F;
      if (!read_float(reader, value)) {
        return false;
      }
      message_.numbers[tag.field - first_number_field] = value;
      return true;
    }
    return reader.skip(tag.type);
  }

  // Nothing when the message is whole.
  [[nodiscard]] std::optional<Rejection> problem() const {
    if (!has_sensor_ || !has_name_ || !type_) {
      return Rejection::missing_field;
    }
    if (*type_ >= description_types) {
      return Rejection::unknown_type;
    }
    return std::nullopt;
  }
  [[nodiscard]] RejectedMessage rejected(Rejection cause) const {
    RejectedMessage rejected{.cause = cause, .sensor = {}, .sample_number = {}};
    if (has_sensor_) {
      rejected.sensor = message_.sensor;
    }
    return rejected;
  }
  DescriptionMessage take() {
    message_.type = static_cast<DescriptionType>(*type_);
    return std::move(message_);
  }

private:
  static constexpr std::uint32_t sensor_field = 1;
  static constexpr std::uint32_t name_field = 2;
  static constexpr std::uint32_t type_field = 3;
  static constexpr std::uint32_t first_text_field = 4;
  static constexpr std::uint32_t first_number_field = 20;
  static constexpr std::uint32_t has_time_ticks_field = 36;

  bool read_number(WireReader& reader, Tag tag) {
    std::uint64_t value = 0;
    if (!reader.varint(value)) {
      return false;
    }
    if (tag.field == sensor_field) {
      message_.sensor = static_cast<std::uint32_t>(value);
      has_sensor_ = true;
    } else if (tag.field == type_field) {
      type_ = value;
    } else if (tag.field == has_time_ticks_field) {
      message_.has_time_ticks = value != 0;
    }
    return true;
  }

  DescriptionMessage message_;
  bool has_sensor_ = false;
  bool has_name_ = false;
  std::optional<std::uint64_t> type_;
};

void decode_description(Bytes bytes, Datagram& datagram) {
  WireReader reader(bytes);
  DescriptionFields fields;
  Tag tag;
  while (!reader.at_end()) {
    if (!read_tag(reader, tag) || !fields.read(reader, tag)) {
      datagram.rejected.push_back(fields.rejected(Rejection::malformed));
      return;
    }
  }
  if (const auto problem = fields.problem()) {
    datagram.rejected.push_back(fields.rejected(*problem));
    return;
  }
  datagram.descriptions.push_back(fields.take());
}

} // namespace

const char* to_string(Rejection rejection) {
  switch (rejection) {
  case Rejection::unknown_keyword:
    return "unknown keyword";
  case Rejection::bad_length:
    return "bad varint length";
  case Rejection::truncated:
    return "truncated message";
  case Rejection::malformed:
    return "malformed message";
  case Rejection::missing_field:
    return "missing required field";
  case Rejection::unknown_type:
    return "unknown description type";
  }
  return "unknown";
}

void decode(Bytes bytes, Datagram& datagram) {
  datagram.data.clear();
  datagram.descriptions.clear();
  datagram.rejected.clear();
  datagram.broken.reset();
  const bool has_keyword = bytes.size() >= keyword_bytes;
  const bool is_data = has_keyword && std::memcmp(bytes.data(), "DATA", keyword_bytes) == 0;
  const bool is_description = has_keyword && std::memcmp(bytes.data(), "DSCP", keyword_bytes) == 0;
  if (!is_data && !is_description) {
    datagram.broken = Rejection::unknown_keyword;
    return;
  }
  WireReader reader(bytes.subspan(keyword_bytes));
  while (!reader.at_end()) {
    const std::size_t left_before = reader.left();
    std::uint64_t length = 0;
    Bytes message;
    if (!reader.varint(length)) {
      datagram.broken = Rejection::bad_length;
      return;
    }
    if (!reader.bytes(length, message)) {
      datagram.broken = Rejection::truncated;
      return;
    }
    if (is_data) {
      decode_data(message, left_before - reader.left(), datagram);
    } else {
      decode_description(message, datagram);
    }
  }
}

} // namespace dyncal::drivers::smartup
