// The newest reading in a CSV file as data loggers write them: any lines before and between, title
// line, byte order mark, separated by comma, semicolon or tab, decimal point or comma. The first
// column has the time, or the first two have day and time: 2026-11-27 23:45:10 (or T between, with
// Z or +01:00 behind), or 27.11.2026 23:45; of this computer's zone where none is stated.
//
// A unit behind a value or in the title's brackets must be the one that is asked for: 296 K is no
// temperature in degC. Fails (bad_file) with the file: not there, no such column or several,
// another unit, no line with time and value. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "services/base/error.hpp"

namespace dyncal::inline programs {

struct LoggerReading {
  std::int64_t utc_ns = 0;
  double value = 0.0;
};

struct LoggerColumn {
  std::string column; // its title, or how it alone begins; or its number, from 1 on
  std::string unit;   // "degC", "%" or "hPa", in which its values are to be
};

[[nodiscard]] Expected<LoggerReading> newest_reading(const std::filesystem::path& file,
                                                     const LoggerColumn& wanted);
// The same of its text; `file` is for messages.
[[nodiscard]] Expected<LoggerReading> newest_reading_of(std::string_view text,
                                                        const LoggerColumn& wanted,
                                                        const std::filesystem::path& file);

// As above; nothing: it is no such time.
[[nodiscard]] std::optional<std::int64_t> logger_time_ns(const std::string& text);
// "23.1", "23,1", with that unit behind at most; nothing: it is no number, or in another unit.
[[nodiscard]] std::optional<double> logger_value(const std::string& text, const std::string& unit);

} // namespace dyncal::inline programs
