#include "drivers/files/csv_rows.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <type_traits>

#include "analysis/base/text.hpp"
#include "drivers/files/decimal.hpp"
#include "drivers/files/regular_stamps.hpp"

namespace dyncal::drivers::files {
namespace {

constexpr std::size_t max_quote = 40;

bool blank(char c) {
  return c == ' ' || c == '\r' || c == '\t';
}

template <class Number>
bool is_whole(std::string_view text, Number& value) {
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size();
}

class RowReader {
public:
  RowReader(std::string_view text, const CsvLayout& layout, CsvRows& rows)
      : at_(text.data()), end_(text.data() + text.size()), layout_(layout),
        columns_(layout.meanings.size()), rows_(rows) {}

  // Until the end or the first problem.
  void read() {
    for (; at_ != end_ && problem_.empty(); ++rows_.lines) {
      if (!skip_blank_line()) {
        read_row();
      }
    }
    close_block();
    if (!problem_.empty()) {
      rows_.problem = CsvRows::Problem{rows_.lines - 1, std::move(problem_)};
    }
  }

private:
  [[nodiscard]] bool at_line_end() const {
    return at_ == end_ || *at_ == '\n' || (*at_ == '\r' && (at_ + 1 == end_ || at_[1] == '\n'));
  }

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
    if (filled_ == CsvRows::block_rows) {
      close_block();
    }
    if (filled_ == 0) {
      open_block();
    }
    std::int64_t stamp_ns = 0;
    std::uint64_t number = any_ ? last_number_ + 1 : 0;
    double* channel = open_.values.data() + filled_;
    for (std::size_t column = 0; column < columns_; ++column) {
      bool read = false;
      switch (layout_.meanings[column]) {
      case CsvMeaning::channel:
        read = read_field(*channel, column);
        channel += CsvRows::block_rows;
        break;
      case CsvMeaning::time:
        read = read_field(stamp_ns, column);
        break;
      case CsvMeaning::number:
        read = read_field(number, column);
        break;
      }
      if (!read) {
        return;
      }
      const bool last = column + 1 == columns_;
      if (last != at_line_end()) {
        problem_ =
            last ? "more fields than the first line has columns (" + std::to_string(columns_) + ")"
                 : std::to_string(column + 1) + " fields, but the first line has " +
                       std::to_string(columns_) + " columns";
        return;
      }
      at_ += last ? 0 : 1;
    }
    if (rises(number)) {
      keep(stamp_ns, number);
    }
    at_ += at_ != end_ && *at_ == '\r' ? 1 : 0;
    at_ += at_ != end_ ? 1 : 0;
  }

  // Leaves at_ at the separator or the end of the line. False: problem_ says why.
  template <class Number>
  bool read_field(Number& value, std::size_t column) {
    const auto [next, status] = read_number(at_, end_, value);
    if (status == std::errc() && (next == end_ || *next == layout_.separator || *next == '\n')) {
      at_ = next;
      return true;
    }
    return read_unusual_field(value, column);
  }

  template <class Number>
  [[gnu::noinline]] bool read_unusual_field(Number& value, std::size_t column) {
    const char* const begin = at_;
    while (at_ != end_ && *at_ != layout_.separator && *at_ != '\n') {
      ++at_;
    }
    std::string_view field = trimmed({begin, static_cast<std::size_t>(at_ - begin)});
    if constexpr (std::is_floating_point_v<Number>) {
      if (field.empty()) {
        value = std::numeric_limits<double>::quiet_NaN();
        return true;
      }
    }
    const std::string_view signless = field.starts_with('+') ? field.substr(1) : field;
    if (is_whole(signless, value)) {
      return true;
    }
    problem_ = "'" + std::string(field.substr(0, max_quote)) + "' in column " +
               layout_.columns[column] + " is not " +
               (std::is_integral_v<Number> ? "a whole number" : "a number");
    return false;
  }

  bool rises(std::uint64_t number) {
    if (any_ && layout_.has_number && number <= last_number_) {
      problem_ = not_rising(number, last_number_);
    }
    return problem_.empty();
  }

  // The values of the row lie in open_ already.
  void keep(std::int64_t stamp_ns, std::uint64_t number) {
    if (filled_ > 0 && number != last_number_ + 1) {
      const std::size_t row = filled_;
      close_block();
      for (std::size_t channel = 0; channel < layout_.channels.size(); ++channel) {
        open_.values[channel * CsvRows::block_rows] =
            open_.values[channel * CsvRows::block_rows + row];
      }
    }
    if (filled_ == 0) {
      open_.first_sample = number;
    }
    if (layout_.has_time) {
      open_.stamps_ns[filled_] = stamp_ns;
    }
    ++filled_;
    any_ = true;
    last_number_ = number;
  }

  void open_block() {
    open_.values.resize(CsvRows::block_rows * layout_.channels.size());
    open_.stamps_ns.resize(layout_.has_time ? CsvRows::block_rows : 0);
  }

  // A full block is given away as it is; of another one a copy that is no larger than it must be.
  void close_block() {
    open_.samples = filled_;
    if (filled_ == CsvRows::block_rows) {
      rows_.blocks.push_back(std::move(open_));
      open_ = {};
    } else if (filled_ > 0) {
      SampleBlock& block = rows_.blocks.emplace_back();
      block.first_sample = open_.first_sample;
      block.samples = filled_;
      if (layout_.has_time) {
        block.stamps_ns.assign(open_.stamps_ns.data(), open_.stamps_ns.data() + filled_);
      }
      block.values.reserve(filled_ * layout_.channels.size());
      for (std::size_t channel = 0; channel < layout_.channels.size(); ++channel) {
        const double* const values = open_.values.data() + channel * CsvRows::block_rows;
        block.values.insert(block.values.end(), values, values + filled_);
      }
    }
    filled_ = 0;
  }

  const char* at_;
  const char* const end_;
  const CsvLayout& layout_;
  const std::size_t columns_;
  CsvRows& rows_;
  SampleBlock open_;       // its columns have room for block_rows rows each
  std::size_t filled_ = 0; // rows of open_
  bool any_ = false;       // rows so far
  std::uint64_t last_number_ = 0;
  std::string problem_;
};

} // namespace

tl::expected<CsvLayout, std::string> CsvLayout::of(std::string_view first_line) {
  CsvLayout layout;
  for (const char candidate : {',', '\t', ';'}) {
    layout.separator =
        first_line.find(candidate) != std::string_view::npos ? candidate : layout.separator;
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
      return tl::unexpected("column " + std::to_string(layout.columns.size() + 1) +
                            " has no name; the first line must name the columns");
    }
    if (std::find(layout.columns.begin(), layout.columns.end(), name) != layout.columns.end()) {
      return tl::unexpected("two columns are called '" + std::string(name) + "'");
    }
    layout.columns.emplace_back(name);
    layout.has_time |= name == "t_ns";
    layout.has_number |= name == "sample_number";
    layout.meanings.push_back(name == "t_ns"            ? CsvMeaning::time
                              : name == "sample_number" ? CsvMeaning::number
                                                        : CsvMeaning::channel);
    if (layout.meanings.back() == CsvMeaning::channel) {
      layout.channels.emplace_back(name);
    }
  }
  return layout;
}

CsvRows read_csv_rows(std::string_view lines, const CsvLayout& layout) {
  CsvRows rows;
  RowReader(lines, layout, rows).read();
  return rows;
}

} // namespace dyncal::drivers::files
