#include "drivers/files/tdms/tdms_property.hpp"

#include <limits>

namespace dyncal::drivers::files {
namespace {

constexpr std::int64_t unix_epoch_s = 2'082'844'800; // since 1904-01-01

std::optional<TdmsValue> read_time(TdmsCursor& cursor) {
  std::uint64_t fraction = 0;
  std::int64_t seconds = 0;
  if (cursor.big_endian()) {
    seconds = cursor.number<std::int64_t>();
    fraction = cursor.number<std::uint64_t>();
  } else {
    fraction = cursor.number<std::uint64_t>();
    seconds = cursor.number<std::int64_t>();
  }
  if (seconds == 0 && fraction == 0) {
    return TdmsValue(); // LabVIEW's time that was never set
  }
  const auto unix_ns = tdms_unix_ns(seconds, fraction);
  return unix_ns ? std::optional<TdmsValue>(TdmsTime{*unix_ns}) : std::nullopt;
}

TdmsValue of_unsigned(std::uint64_t value) {
  return value <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())
             ? TdmsValue(static_cast<std::int64_t>(value))
             : TdmsValue(static_cast<double>(value));
}

} // namespace

std::optional<std::size_t> size_of(TdmsType type) {
  switch (type) {
  case TdmsType::none:
  case TdmsType::text:
  case TdmsType::daqmx_raw:
    return 0;
  case TdmsType::i8:
  case TdmsType::u8:
  case TdmsType::boolean:
    return 1;
  case TdmsType::i16:
  case TdmsType::u16:
    return 2;
  case TdmsType::i32:
  case TdmsType::u32:
  case TdmsType::f32:
  case TdmsType::f32_with_unit:
    return 4;
  case TdmsType::i64:
  case TdmsType::u64:
  case TdmsType::f64:
  case TdmsType::f64_with_unit:
  case TdmsType::complex_f32:
    return 8;
  case TdmsType::time:
  case TdmsType::complex_f64:
    return 16;
  }
  return std::nullopt;
}

bool is_complex(TdmsType type) {
  return type == TdmsType::complex_f32 || type == TdmsType::complex_f64;
}

bool is_number(TdmsType type) {
  return type != TdmsType::none && type != TdmsType::text && type != TdmsType::time;
}

std::optional<std::int64_t> tdms_unix_ns(std::int64_t seconds_since_1904, std::uint64_t fraction) {
  __extension__ using Wide = unsigned __int128;
  const auto part_ns = static_cast<std::int64_t>(
      (static_cast<Wide>(fraction) * tdms_second_ns + (Wide{1} << 63U)) >> 64U);
  std::int64_t ns = 0;
  if (__builtin_sub_overflow(seconds_since_1904, unix_epoch_s, &ns) ||
      __builtin_mul_overflow(ns, tdms_second_ns, &ns) || __builtin_add_overflow(ns, part_ns, &ns)) {
    return std::nullopt;
  }
  return ns;
}

std::optional<TdmsValue> read_tdms_value(TdmsCursor& cursor, TdmsType type) {
  switch (type) {
  case TdmsType::i8:
    return std::int64_t{cursor.number<std::int8_t>()};
  case TdmsType::i16:
    return std::int64_t{cursor.number<std::int16_t>()};
  case TdmsType::i32:
    return std::int64_t{cursor.number<std::int32_t>()};
  case TdmsType::i64:
    return cursor.number<std::int64_t>();
  case TdmsType::u8:
  case TdmsType::boolean:
    return std::int64_t{cursor.number<std::uint8_t>()};
  case TdmsType::u16:
    return std::int64_t{cursor.number<std::uint16_t>()};
  case TdmsType::u32:
    return std::int64_t{cursor.number<std::uint32_t>()};
  case TdmsType::u64:
    return of_unsigned(cursor.number<std::uint64_t>());
  case TdmsType::f32:
  case TdmsType::f32_with_unit:
    return double{cursor.number<float>()};
  case TdmsType::f64:
  case TdmsType::f64_with_unit:
    return cursor.number<double>();
  case TdmsType::text:
    return cursor.text();
  case TdmsType::time:
    return read_time(cursor);
  case TdmsType::complex_f32:
  case TdmsType::complex_f64:
    cursor.skip(*size_of(type));
    return TdmsValue();
  case TdmsType::none:
  case TdmsType::daqmx_raw:
    break;
  }
  return std::nullopt;
}

std::optional<double> number_in(const TdmsProperties& properties, const std::string& name) {
  const auto found = properties.find(name);
  if (found == properties.end()) {
    return std::nullopt;
  }
  if (const auto* whole = std::get_if<std::int64_t>(&found->second)) {
    return static_cast<double>(*whole);
  }
  const auto* number = std::get_if<double>(&found->second);
  return number == nullptr ? std::nullopt : std::optional(*number);
}

std::optional<std::int64_t> whole_number_in(const TdmsProperties& properties,
                                            const std::string& name) {
  const auto found = properties.find(name);
  const auto* whole =
      found == properties.end() ? nullptr : std::get_if<std::int64_t>(&found->second);
  return whole == nullptr ? std::nullopt : std::optional(*whole);
}

std::string text_in(const TdmsProperties& properties, const std::string& name) {
  const auto found = properties.find(name);
  const auto* text = found == properties.end() ? nullptr : std::get_if<std::string>(&found->second);
  return text == nullptr ? std::string() : *text;
}

} // namespace dyncal::drivers::files
