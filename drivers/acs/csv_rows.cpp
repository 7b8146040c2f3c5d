#include "drivers/acs/csv_rows.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <type_traits>

#include "drivers/acs/regular_stamps.hpp"

namespace dyncal::drivers::acs {
namespace {

constexpr std::size_t longest_quote = 40;

bool blank(char c) {
  return c == ' ' || c == '\r' || c == '\t';
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && blank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && blank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

template <class Number>
bool is_whole(std::string_view text, Number& value) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size();
}

// Eight decimal digits at once, the sums of neighbours formed side by side in one word; false when they are not eight digits.
bool eight_digits(const char* text, std::uint64_t& value) {
  std::uint64_t word = 0;
  std::memcpy(&word, text, sizeof(word));
  constexpr std::uint64_t zeros = 0x3030303030303030;
  constexpr std::uint64_t high = 0xF0F0F0F0F0F0F0F0;
  if ((word & high) != zeros || ((word + 0x0606060606060606) & high) != zeros) {
    return false;
  }
  word = ((word - zeros) * (1 + (10U << 8U))) >> 8U;
  word = ((word & 0x00FF00FF00FF00FF) * (1 + (100ULL << 16U))) >> 16U;
  value = ((word & 0x0000FFFF0000FFFF) * (1 + (10000ULL << 32U))) >> 32U;
  return true;
}

// As std::from_chars; stamps of 17 to 19 digits several times as fast.
std::from_chars_result read_number(const char* at, const char* end, std::int64_t& value) {
  if constexpr (std::endian::native == std::endian::little) {
    std::uint64_t first = 0;
    std::uint64_t second = 0;
    if (end - at > 19 && eight_digits(at, first) && eight_digits(at + 8, second)) {
      std::uint64_t number = first * 100'000'000 + second;
      const char* c = at + 16;
      for (; c != at + 19 && *c >= '0' && *c <= '9'; ++c) {
        number = number * 10 + static_cast<std::uint64_t>(*c - '0');
      }
      if ((*c < '0' || *c > '9') && number <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
        value = static_cast<std::int64_t>(number);
        return {c, std::errc()};
      }
    }
  }
  return std::from_chars(at, end, value);
}

template <class Number>
std::from_chars_result read_number(const char* at, const char* end, Number& value) {
  return std::from_chars(at, end, value);
}

class RowReader {
public:
  RowReader(std::string_view text, const CsvLayout& layout, CsvRows& rows)
      : at_(text.data()), end_(text.data() + text.size()), layout_(layout), rows_(rows) {}

  // Until the end or the first problem.
  void read() {
    for (; at_ != end_ && problem_.empty(); ++rows_.lines) {
      if (!skip_blank_line()) {
        read_row();
      }
    }
    if (!problem_.empty()) {
      rows_.problem = CsvRows::Problem{rows_.lines - 1, std::move(problem_)};
    }
  }

private:
  [[nodiscard]] bool at_line_end() const { return at_ == end_ || *at_ == '\n' || (*at_ == '\r' && (at_ + 1 == end_ || at_[1] == '\n')); }

  bool skip_blank_line() {
    const char* c = at_;
    while (c != end_ && blank(*c)) {
      ++c;
    }
    if (c != end_ && *c != '\n') {
      return false;
    }
    at_ = c == end_ ? c : c + 1;
    return true;
  }

  void read_row() {
    const std::size_t columns = layout_.meanings.size();
    double* channel = rows_.values.get() + rows_.rows;
    for (std::size_t column = 0; column < columns; ++column) {
      switch (layout_.meanings[column]) {
      case CsvMeaning::channel:
        read_field(*channel, column);
        channel += rows_.capacity;
        break;
      case CsvMeaning::time:
        read_field(rows_.stamps_ns[rows_.rows], column);
        break;
      case CsvMeaning::number:
        read_field(rows_.sample_numbers[rows_.rows], column);
        break;
      }
      if (!problem_.empty()) {
        return;
      }
      const bool last = column + 1 == columns;
      if (last != at_line_end()) {
        problem_ = last ? "more fields than the first line has columns (" + std::to_string(columns) + ")"
                        : std::to_string(column + 1) + " fields, but the first line has " + std::to_string(columns) + " columns";
        return;
      }
      at_ += last ? 0 : 1;
    }
    check_order();
    rows_.rows += problem_.empty() ? 1 : 0;
    at_ = std::find(at_, end_, '\n');
    at_ += at_ == end_ ? 0 : 1;
  }

  // Leaves at_ at the separator or the end of the line.
  template <class Number>
  void read_field(Number& value, std::size_t column) {
    const auto [next, status] = read_number(at_, end_, value);
    if (status == std::errc() && (next == end_ || *next == layout_.separator || *next == '\n')) {
      at_ = next;
      return;
    }
    const char* const begin = at_;
    while (at_ != end_ && *at_ != layout_.separator && *at_ != '\n') {
      ++at_;
    }
    std::string_view field = trimmed({begin, static_cast<std::size_t>(at_ - begin)});
    if constexpr (std::is_floating_point_v<Number>) {
      if (field.empty()) {
        value = std::numeric_limits<double>::quiet_NaN();
        return;
      }
    }
    const std::string_view signless = field.starts_with('+') ? field.substr(1) : field;
    if (!is_whole(signless, value)) {
      problem_ = "'" + std::string(field.substr(0, longest_quote)) + "' in column " + layout_.columns[column] + " is not " +
                 (std::is_integral_v<Number> ? "a whole number" : "a number");
    }
  }

  void check_order() {
    const std::size_t row = rows_.rows;
    if (row == 0) {
      return;
    }
    if (layout_.has_number && rows_.sample_numbers[row] <= rows_.sample_numbers[row - 1]) {
      problem_ = not_rising(rows_.sample_numbers[row], rows_.sample_numbers[row - 1]);
    } else if (layout_.has_time && rows_.stamps_ns[row] <= rows_.stamps_ns[row - 1]) {
      problem_ = not_rising(rows_.stamps_ns[row], rows_.stamps_ns[row - 1]);
    }
  }

  const char* at_;
  const char* const end_;
  const CsvLayout& layout_;
  CsvRows& rows_;
  std::string problem_;
};

} // namespace

tl::expected<CsvLayout, std::string> CsvLayout::of(std::string_view first_line) {
  CsvLayout layout;
  for (const char candidate : {',', '\t', ';'}) {
    layout.separator = first_line.find(candidate) != std::string_view::npos ? candidate : layout.separator;
  }
  for (std::size_t begin = 0; begin <= first_line.size();) {
    const std::size_t end = std::min(first_line.find(layout.separator, begin), first_line.size());
    std::string_view name = trimmed(first_line.substr(begin, end - begin));
    begin = end + 1;
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') {
      name = name.substr(1, name.size() - 2);
    }
    double number = 0.0;
    if (name.empty() || is_whole(name, number)) {
      return tl::unexpected("column " + std::to_string(layout.columns.size() + 1) + " has no name; the first line must name the columns");
    }
    if (std::find(layout.columns.begin(), layout.columns.end(), name) != layout.columns.end()) {
      return tl::unexpected("two columns are called '" + std::string(name) + "'");
    }
    layout.columns.emplace_back(name);
    layout.has_time |= name == "t_ns";
    layout.has_number |= name == "sample_number";
    layout.meanings.push_back(name == "t_ns" ? CsvMeaning::time : name == "sample_number" ? CsvMeaning::number : CsvMeaning::channel);
    if (layout.meanings.back() == CsvMeaning::channel) {
      layout.channels.emplace_back(name);
    }
  }
  return layout;
}

CsvRows read_csv_rows(std::string_view lines, const CsvLayout& layout) {
  CsvRows rows;
  rows.capacity = static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n')) + 1;
  rows.stamps_ns.resize(layout.has_time ? rows.capacity : 0);
  rows.sample_numbers.resize(layout.has_number ? rows.capacity : 0);
  rows.values = std::make_unique_for_overwrite<double[]>(rows.capacity * layout.channels.size());
  RowReader(lines, layout, rows).read();
  return rows;
}

} // namespace dyncal::drivers::acs
