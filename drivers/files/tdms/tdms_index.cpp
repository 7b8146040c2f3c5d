#include "drivers/files/tdms/tdms_index.hpp"

#include <array>

namespace dyncal::drivers::files {
namespace {

constexpr std::uint32_t format_changing = 0x1269;
constexpr std::uint32_t digital_line = 0x126A;

using Problem = tl::unexpected<std::string>;

Problem unknown_type(std::uint32_t type) {
  return Problem("has values of type " + std::to_string(type) + ", which cannot be read");
}

// DAQmx numbers types in its own way.
std::optional<TdmsType> type_of_scaler(std::uint32_t code) {
  constexpr std::array types{TdmsType::u8,  TdmsType::i8,  TdmsType::u16, TdmsType::i16,
                             TdmsType::u32, TdmsType::i32, TdmsType::u64, TdmsType::i64,
                             TdmsType::f32, TdmsType::f64};
  return code < types.size() ? std::optional(types[code]) : std::nullopt;
}

tl::expected<TdmsScaler, std::string> read_scaler(TdmsCursor& cursor, bool is_line) {
  const auto code = cursor.number<std::uint32_t>();
  TdmsScaler scaler;
  scaler.buffer = cursor.number<std::uint32_t>();
  scaler.byte_in_row = cursor.number<std::uint32_t>();
  cursor.skip(is_line ? 1 : 4); // the bitmap of the format
  scaler.id = cursor.number<std::uint32_t>();
  const auto type = type_of_scaler(code);
  if (!type) {
    return Problem("has raw data of DAQmx of type " + std::to_string(code) +
                   ", which cannot be read");
  }
  scaler.type = *type;
  if (is_line) {
    scaler.bit = static_cast<int>(scaler.byte_in_row % 8);
    scaler.byte_in_row /= 8;
  }
  return scaler;
}

tl::expected<TdmsIndex, std::string> read_daqmx(TdmsCursor& cursor, bool is_line) {
  TdmsIndex index;
  index.is_daqmx = true;
  index.type = static_cast<TdmsType>(cursor.number<std::uint32_t>());
  if (!size_of(index.type)) {
    return unknown_type(static_cast<std::uint32_t>(index.type));
  }
  const auto dimension = cursor.number<std::uint32_t>();
  index.values = cursor.number<std::uint64_t>();
  for (auto left = cursor.number<std::uint32_t>(); left > 0 && !cursor.failed(); --left) {
    auto scaler = read_scaler(cursor, is_line);
    if (!scaler) {
      return Problem(scaler.error());
    }
    index.scalers.push_back(*scaler);
  }
  for (auto left = cursor.number<std::uint32_t>(); left > 0 && !cursor.failed(); --left) {
    index.row_bytes.push_back(cursor.number<std::uint32_t>());
  }
  if (dimension != 1) {
    return Problem("has values of " + std::to_string(dimension) + " dimensions, not of one");
  }
  if (index.type != TdmsType::daqmx_raw) { // then its one scaler has no number
    if (index.scalers.size() != 1) {
      return Problem("has " + std::to_string(index.scalers.size()) +
                     " sets of raw data of DAQmx, but values of one type");
    }
    index.scalers.front().id = tdms_raw_input;
  }
  for (const TdmsScaler& scaler : index.scalers) {
    const std::uint64_t end = std::uint64_t{scaler.byte_in_row} + *size_of(scaler.type);
    if (scaler.buffer >= index.row_bytes.size() || end > index.row_bytes[scaler.buffer]) {
      return Problem("has raw data of DAQmx beyond the end of a row");
    }
  }
  return index;
}

} // namespace

tl::expected<TdmsIndex, std::string> read_tdms_index(TdmsCursor& cursor, std::uint32_t header) {
  if (header == format_changing || header == digital_line) {
    return read_daqmx(cursor, header == digital_line);
  }
  TdmsIndex index;
  index.type = static_cast<TdmsType>(cursor.number<std::uint32_t>());
  const auto dimension = cursor.number<std::uint32_t>();
  index.values = cursor.number<std::uint64_t>();
  const auto size = size_of(index.type);
  if (!size || index.type == TdmsType::daqmx_raw) {
    return unknown_type(static_cast<std::uint32_t>(index.type));
  }
  if (dimension != 1) {
    return Problem("has values of " + std::to_string(dimension) + " dimensions, not of one");
  }
  if (index.type == TdmsType::text) {
    index.bytes = cursor.number<std::uint64_t>();
  } else if (__builtin_mul_overflow(index.values, *size, &index.bytes)) {
    return Problem("has " + std::to_string(index.values) + " values, more than any file holds");
  }
  return index;
}

} // namespace dyncal::drivers::files
