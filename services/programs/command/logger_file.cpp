#include "services/programs/command/logger_file.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <vector>

#include <fmt/format.h>

#include "services/base/csv_rows.hpp"
#include "services/base/parsed_number.hpp"
#include "services/base/whole_file.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::uintmax_t max_file_bytes = 1U << 28U;
constexpr std::int64_t second_ns = 1'000'000'000;

// As loggers and people write the unit that a quantity is stated in; small letters.
struct UnitSpellings {
  std::string_view unit;
  std::vector<std::string_view> spellings;
};
const std::vector<UnitSpellings>& known_units() {
  static const std::vector<UnitSpellings> units{
      {"degC",
       {"degc",
        "\xC2\xB0"
        "c",
        "\xB0"
        "c",
        "c", "deg c"}},
      {"%", {"%", "%rh", "% rh", "%rf", "% rf", "% r.h.", "% r.f."}},
      {"hPa", {"hpa", "mbar"}}};
  return units;
}

std::string in_small_letters(std::string text) {
  std::ranges::transform(text, text.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  return text;
}

bool is_unit(const std::string& text, std::string_view unit) {
  const auto known = std::ranges::find(known_units(), unit, &UnitSpellings::unit);
  return known != known_units().end() &&
         std::ranges::find(known->spellings, in_small_letters(text)) != known->spellings.end();
}

// "K" of "Temp [K]": what stands in the last brackets, where that is a unit of such a quantity and
// not the one that is asked for; empty: nothing speaks against it.
std::string other_unit_of(const std::string& title, std::string_view unit) {
  const std::size_t begin = title.find_last_of("([");
  const std::size_t end = begin == std::string::npos ? begin : title.find_first_of(")]", begin);
  if (end == std::string::npos) {
    return "";
  }
  const std::string named = title.substr(begin + 1, end - begin - 1);
  static const std::vector<std::string_view> others{"k",
                                                    "kelvin",
                                                    "f",
                                                    "degf",
                                                    "\xC2\xB0"
                                                    "f",
                                                    "\xB0"
                                                    "f",
                                                    "pa",
                                                    "kpa",
                                                    "bar",
                                                    "torr",
                                                    "psi",
                                                    "mmhg",
                                                    "inhg"};
  const bool is_other = std::ranges::find(others, in_small_letters(named)) != others.end() ||
                        std::ranges::any_of(known_units(), [&](const UnitSpellings& one) {
                          return one.unit != unit && is_unit(named, one.unit);
                        });
  return is_other ? named : "";
}

std::vector<std::string_view> lines_of(std::string_view text) {
  text = without_byte_order_mark(text);
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

// Of the title, or of the only one that begins so.
Expected<ColumnPlace> place_in(const std::vector<std::string>& titles, const std::string& column,
                               const std::string& unit) {
  auto found = std::ranges::find(titles, column);
  if (found == titles.end()) {
    const auto begins_so = [&](const std::string& title) { return title.starts_with(column); };
    found = std::ranges::find_if(titles, begins_so);
    if (std::ranges::count_if(titles, begins_so) > 1) {
      return fail(ErrorCode::bad_file,
                  fmt::format("several columns begin with '{}'; name one whole", column));
    }
  }
  if (const std::string other = other_unit_of(*found, unit); !other.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("column '{}' is in {}, not in {}", *found, other, unit));
  }
  return ColumnPlace{static_cast<std::size_t>(found - titles.begin()), titles.size()};
}

Expected<ColumnPlace> place_of(const std::vector<std::string_view>& lines,
                               const std::string& column, const std::string& unit) {
  if (const auto number = parsed_number<std::size_t>(column); number && *number > 0) {
    return ColumnPlace{*number - 1, 0};
  }
  for (const std::string_view line : lines) {
    const auto cells = csv_fields(line, csv_separator(line));
    const bool has_title = std::ranges::any_of(
        cells, [&](const std::string& title) { return title.starts_with(column); });
    if (has_title && cells.size() > 1) {
      return place_in(cells, column, unit);
    }
  }
  return fail(ErrorCode::bad_file, fmt::format("has no column '{}'", column));
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

std::optional<double> logger_value(const std::string& text, const std::string& unit) {
  const std::size_t end = std::min(text.find_first_not_of("+-0123456789.,eE"), text.size());
  std::string number = text.substr(0, end);
  std::ranges::replace(number, ',', '.');
  number.erase(0, number.starts_with('+') ? 1 : 0);
  const std::string rest = text.substr(std::min(text.find_first_not_of(' ', end), text.size()));
  return rest.empty() || is_unit(rest, unit) ? parsed_number<double>(number) : std::nullopt;
}

Expected<LoggerReading> newest_reading_of(std::string_view text, const LoggerColumn& wanted,
                                          const std::filesystem::path& file) {
  const std::vector<std::string_view> lines = lines_of(text);
  const auto place = place_of(lines, wanted.column, wanted.unit);
  if (!place) {
    return fail(ErrorCode::bad_file, fmt::format("{}: {}", file.string(), place.error().message));
  }
  std::optional<LoggerReading> newest;
  for (const std::string_view line : lines) {
    const auto cells = csv_fields(line, csv_separator(line));
    // A decimal comma between commas would make two cells of a number.
    const bool is_like_title = place->cells == 0 || cells.size() == place->cells;
    const auto utc_ns = time_in(cells);
    const auto value = is_like_title && place->number < cells.size()
                           ? logger_value(cells[place->number], wanted.unit)
                           : std::nullopt;
    if (utc_ns && value && (!newest || *utc_ns >= newest->utc_ns)) {
      newest = LoggerReading{*utc_ns, *value};
    }
  }
  if (!newest) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: has no line with a time (2026-11-27 23:45:10) and a number, in {} "
                            "where it has a unit, in column '{}'",
                            file.string(), wanted.unit, wanted.column));
  }
  return *newest;
}

Expected<LoggerReading> newest_reading(const std::filesystem::path& file,
                                       const LoggerColumn& wanted) {
  DYNCAL_TRY(const auto text, read_whole_file(file, max_file_bytes));
  return newest_reading_of(text, wanted, file);
}

} // namespace dyncal::inline programs
