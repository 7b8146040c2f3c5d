#include "services/programs/command/logger_file.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <vector>

#include <fmt/format.h>

#include "services/base/parsed_number.hpp"
#include "services/base/whole_file.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::uintmax_t max_file_bytes = 1U << 28U;
constexpr std::int64_t second_ns = 1'000'000'000;

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  const auto last = text.find_last_not_of(" \t\r\"");
  return first == std::string_view::npos ? "" : std::string(text.substr(first, last - first + 1));
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
  std::vector<std::string> cells;
  std::string cell;
  bool quoted = false;
  for (const char letter : line) {
    quoted = letter == '"' ? !quoted : quoted;
    if (letter == separator && !quoted) {
      cells.push_back(trimmed(cell));
      cell.clear();
    } else {
      cell += letter;
    }
  }
  cells.push_back(trimmed(cell));
  return cells;
}

char separator_of(std::string_view line) {
  for (const char one : {';', '\t'}) {
    if (line.find(one) != std::string_view::npos) {
      return one;
    }
  }
  return ',';
}

std::vector<std::string_view> lines_of(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  text.remove_prefix(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

struct ColumnPlace {
  std::size_t number = 0; // from 0 on
  std::size_t cells = 0;  // of the title line; 0: not known
};

// Nothing: no line has such a title.
std::optional<ColumnPlace> place_of(const std::vector<std::string_view>& lines,
                                    const std::string& column) {
  if (const auto number = parsed_number<std::size_t>(column); number && *number > 0) {
    return ColumnPlace{*number - 1, 0};
  }
  for (const std::string_view line : lines) {
    const auto cells = cells_of(line, separator_of(line));
    for (const bool whole : {true, false}) {
      const auto found = std::ranges::find_if(cells, [&](const std::string& title) {
        return whole ? title == column : title.starts_with(column);
      });
      if (found != cells.end() && cells.size() > 1) {
        return ColumnPlace{static_cast<std::size_t>(found - cells.begin()), cells.size()};
      }
    }
  }
  return std::nullopt;
}

std::optional<std::int64_t> time_in(const std::vector<std::string>& cells) {
  const auto in_one = logger_time_ns(cells.front());
  return in_one || cells.size() < 2 ? in_one : logger_time_ns(cells[0] + " " + cells[1]);
}

// Behind the seconds: a fraction, then a zone. Nothing: something else.
struct Tail {
  bool has_zone = false;
  std::int64_t offset_s = 0;
};
std::optional<Tail> tail_of(std::string_view text) {
  if (text.starts_with('.') || text.starts_with(',')) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789", 1), text.size());
    text.remove_prefix(end);
  }
  if (text.empty()) {
    return Tail{};
  }
  if (text == "Z" || text == " UTC") {
    return Tail{true, 0};
  }
  constexpr std::size_t zone_length = 6; // "+01:00"
  const auto hours =
      text.size() == zone_length ? parsed_number<int>(text.substr(1, 2)) : std::optional<int>();
  const auto minutes = hours ? parsed_number<int>(text.substr(4, 2)) : std::optional<int>();
  if (!minutes || (text[0] != '+' && text[0] != '-') || text[3] != ':') {
    return std::nullopt;
  }
  return Tail{true, (text[0] == '-' ? -1 : 1) * (3600 * *hours + 60 * *minutes)};
}

// Date and time of a line, and how many letters they take.
bool read_calendar(const std::string& text, std::tm& time, int& length) {
  for (const char* form :
       {"%4d-%2d-%2d%*1[T ]%2d:%2d%n:%2d%n", "%4d/%2d/%2d%*1[T ]%2d:%2d%n:%2d%n"}) {
    time = {};
    length = 0;
    if (std::sscanf(text.c_str(), form, &time.tm_year, &time.tm_mon, &time.tm_mday, &time.tm_hour,
                    &time.tm_min, &length, &time.tm_sec, &length) >= 5) {
      return true;
    }
  }
  time = {};
  length = 0;
  return std::sscanf(text.c_str(), "%2d.%2d.%4d%*1[T ]%2d:%2d%n:%2d%n", &time.tm_mday, &time.tm_mon,
                     &time.tm_year, &time.tm_hour, &time.tm_min, &length, &time.tm_sec,
                     &length) >= 5;
}

} // namespace

std::optional<std::int64_t> logger_time_ns(const std::string& text) {
  std::tm time{};
  int length = 0;
  if (!read_calendar(text, time, length) || time.tm_year < 1970 || time.tm_mon < 1 ||
      time.tm_mon > 12 || time.tm_mday < 1 || time.tm_mday > 31) {
    return std::nullopt;
  }
  const auto tail = tail_of(std::string_view(text).substr(static_cast<std::size_t>(length)));
  if (!tail) {
    return std::nullopt;
  }
  time.tm_year -= 1900;
  time.tm_mon -= 1;
  time.tm_isdst = -1;
  const std::time_t seconds = tail->has_zone ? timegm(&time) - tail->offset_s : std::mktime(&time);
  return std::int64_t{seconds} * second_ns;
}

std::optional<double> logger_value(const std::string& text) {
  std::string number = text.substr(0, text.find_first_not_of("+-0123456789.,eE"));
  std::ranges::replace(number, ',', '.');
  number.erase(0, number.starts_with('+') ? 1 : 0);
  const std::string rest = trimmed(std::string_view(text).substr(
      std::min(text.size(), text.find_first_not_of("+-0123456789.,eE"))));
  constexpr std::size_t longest_unit = 6;
  const bool is_unit =
      rest.size() <= longest_unit && rest.find_first_of("0123456789") == std::string::npos;
  return is_unit ? parsed_number<double>(number) : std::nullopt;
}

Expected<LoggerReading> newest_reading_of(std::string_view text, const std::string& column,
                                          const std::filesystem::path& file) {
  const std::vector<std::string_view> lines = lines_of(text);
  const auto place = place_of(lines, column);
  if (!place) {
    return fail(ErrorCode::bad_file, fmt::format("{}: has no column '{}'", file.string(), column));
  }
  std::optional<LoggerReading> newest;
  for (const std::string_view line : lines) {
    const auto cells = cells_of(line, separator_of(line));
    // A decimal comma between commas would make two cells of a number.
    const bool is_like_title = place->cells == 0 || cells.size() == place->cells;
    const auto utc_ns = time_in(cells);
    const auto value = is_like_title && place->number < cells.size()
                           ? logger_value(cells[place->number])
                           : std::nullopt;
    if (utc_ns && value && (!newest || *utc_ns >= newest->utc_ns)) {
      newest = LoggerReading{*utc_ns, *value};
    }
  }
  if (!newest) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: has no line with a time (2026-11-27 23:45:10) and a number in "
                            "column '{}'",
                            file.string(), column));
  }
  return *newest;
}

Expected<LoggerReading> newest_reading(const std::filesystem::path& file,
                                       const std::string& column) {
  DYNCAL_TRY(const auto text, read_whole_file(file, max_file_bytes));
  return newest_reading_of(text, column, file);
}

} // namespace dyncal::inline programs
