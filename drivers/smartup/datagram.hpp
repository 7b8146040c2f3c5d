// Decodes one datagram of a SmartUp Unit: the keyword DATA or DSCP, then [varint length][message]
// to its end (schema: smartup.proto).
//
// What cannot be a message is named with its cause and changes nothing else: a message without a
// required field is left out and the following one is read; from a broken frame on (length not a
// varint, or longer than what is left) nothing more can be read, and what came before it is kept.
// Presence is kept: an absent channel was not measured, and 0.0 is a value. Unknown fields are
// skipped; field 36 of a description (required by newer firmware, unknown to older) is optional
// here, or every older unit would be refused. Any thread; nothing is allocated for data once a
// Datagram has been used before.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dyncal::drivers::smartup {

inline constexpr std::size_t channels_of_unit = 16; // Data_01 ... Data_16

enum class Rejection {
  unknown_keyword, // the first four bytes are neither DATA nor DSCP
  bad_length,      // the length of a message is not a varint
  truncated,       // a message is longer than what is left of the datagram
  malformed,       // the bytes of a message are not fields
  missing_field,   // a required field is absent
  unknown_type     // a description of a type that does not exist
};
inline constexpr std::size_t rejections = 6;

[[nodiscard]] const char* to_string(Rejection rejection);

struct DataMessage {
  std::uint32_t sensor = 0;
  std::uint32_t sample_number = 0;
  std::uint32_t unix_time_s = 0;
  std::uint32_t nanoseconds = 0;
  std::uint32_t time_uncertainty_ns = 0; // as sent: four standard uncertainties; 0: not trustworthy
  std::uint16_t present = 0;             // bit i: Data_(i+1) was measured
  std::uint16_t bytes = 0;               // of the message and its length, on the wire
  std::array<float, channels_of_unit> values{};
  std::optional<std::uint64_t> time_ticks;

  [[nodiscard]] std::int64_t stamp_ns() const {
    return std::int64_t{unix_time_s} * 1'000'000'000 + nanoseconds;
  }
};

enum class DescriptionType {
  physical_quantity = 0,
  unit = 1,
  uncertainty_type = 2,
  resolution = 3,
  min_scale = 4,
  max_scale = 5,
  hierarchy = 6
};
inline constexpr std::size_t description_types = 7;

struct DescriptionMessage {
  std::uint32_t sensor = 0;
  std::string sensor_name;
  DescriptionType type = DescriptionType::physical_quantity;
  std::array<std::optional<std::string>, channels_of_unit> texts;
  std::array<std::optional<float>, channels_of_unit> numbers;
  std::optional<bool> has_time_ticks;
};

struct RejectedMessage {
  Rejection cause = Rejection::malformed;
  std::optional<std::uint32_t> sensor; // as far as they could be read
  std::optional<std::uint32_t> sample_number;
};

struct Datagram {
  std::vector<DataMessage> data;
  std::vector<DescriptionMessage> descriptions;
  std::vector<RejectedMessage> rejected; // single messages
  std::optional<Rejection> broken;       // why the rest (or all) of the datagram could not be read
};

// Overwrites `datagram`.
void decode(std::span<const std::uint8_t> bytes, Datagram& datagram);

} // namespace dyncal::drivers::smartup
