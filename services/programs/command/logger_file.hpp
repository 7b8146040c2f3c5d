// The newest reading in a CSV file as data loggers write them: any lines before and between, title
// line, byte order mark, separated by comma, semicolon or tab, decimal point or comma. The first
// column has the time, or the first two have day and time: 2026-11-27 23:45:10 (or T between, with
// Z or +01:00 behind), or 27.11.2026 23:45; of this computer's zone where none is stated.
//
// Fails (bad_file) with the file: not there, no such column, no line with time and value. Any
// thread.
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

// `column`: its title, or how it begins; or its number, from 1 on.
[[nodiscard]] Expected<LoggerReading> newest_reading(const std::filesystem::path& file,
                                                     const std::string& column);
// The same of its text; `file` is for messages.
[[nodiscard]] Expected<LoggerReading> newest_reading_of(std::string_view text,
                                                        const std::string& column,
                                                        const std::filesystem::path& file);

// As above; nothing: it is no such time.
[[nodiscard]] std::optional<std::int64_t> logger_time_ns(const std::string& text);
// "23.1", "23,1", with a unit behind at most; nothing: it is no number.
[[nodiscard]] std::optional<double> logger_value(const std::string& text);

} // namespace dyncal::inline programs
