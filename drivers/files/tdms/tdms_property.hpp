// Properties of a TDMS file, its groups and channels, and its types of values.
//
// Whole numbers are kept as int64, those of 64 bits without sign above its end as double. A time
// stamp is kept as nanoseconds since 1970-01-01 UTC, rounded to the nearest. Complex numbers are
// passed over. Plain functions, any thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "drivers/files/tdms/tdms_cursor.hpp"

namespace dyncal::drivers::files {

// As the file has them; those of DAQmx's scalers are others (tdms_index.hpp).
enum class TdmsType : std::uint32_t {
  none = 0,
  i8 = 1,
  i16 = 2,
  i32 = 3,
  i64 = 4,
  u8 = 5,
  u16 = 6,
  u32 = 7,
  u64 = 8,
  f32 = 9,
  f64 = 10,
  f32_with_unit = 0x19,
  f64_with_unit = 0x1A,
  text = 0x20,
  boolean = 0x21,
  time = 0x44,
  complex_f32 = 0x08000C,
  complex_f64 = 0x10000D,
  daqmx_raw = 0xFFFFFFFF
};

// Bytes of one value; 0: none or of no fixed size, nothing: no type that can be read.
[[nodiscard]] std::optional<std::size_t> size_of(TdmsType type);
[[nodiscard]] bool is_complex(TdmsType type);
// Whether its values are real or complex numbers, so a channel of samples.
[[nodiscard]] bool is_number(TdmsType type);

inline constexpr std::int64_t tdms_second_ns = 1'000'000'000;

struct TdmsTime {
  std::int64_t unix_ns = 0;
};

using TdmsValue = std::variant<std::monostate, double, std::int64_t, std::string, TdmsTime>;
using TdmsProperties = std::map<std::string, TdmsValue>;

// Nothing for years that 64 bits of nanoseconds do not hold (1678 to 2262).
[[nodiscard]] std::optional<std::int64_t> tdms_unix_ns(std::int64_t seconds_since_1904,
                                                       std::uint64_t fraction);

// The next value of this type; nothing: a type, or a time, that cannot be read.
[[nodiscard]] std::optional<TdmsValue> read_tdms_value(TdmsCursor& cursor, TdmsType type);

// Nothing where it is not there or of another kind; whole numbers are numbers too.
[[nodiscard]] std::optional<double> number_in(const TdmsProperties& properties,
                                              const std::string& name);
[[nodiscard]] std::optional<std::int64_t> whole_number_in(const TdmsProperties& properties,
                                                          const std::string& name);
[[nodiscard]] std::string text_in(const TdmsProperties& properties, const std::string& name);

} // namespace dyncal::drivers::files
