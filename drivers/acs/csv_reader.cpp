#include "drivers/acs/csv_reader.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <type_traits>

#include "drivers/acs/file_channels.hpp"

namespace dyncal::drivers::acs {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\r' || c == '\t'; };
  while (!text.empty() && blank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && blank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

// Takes the next field off the front of `rest`; false when there is none left.
bool next_field(std::string_view& rest, bool& more, char separator, std::string_view& field) {
  if (!more) {
    return false;
  }
  const std::size_t end = rest.find(separator);
  field = trimmed(rest.substr(0, end));
  more = end != std::string_view::npos;
  rest.remove_prefix(more ? end + 1 : rest.size());
  return true;
}

char separator_of(std::string_view header) {
  for (const char candidate : {';', '\t'}) {
    if (header.find(candidate) != std::string_view::npos) {
      return candidate;
    }
  }
  return ',';
}

bool is_number(std::string_view text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size();
}

// One clock for the whole block when its stamps are exactly equidistant.
void make_regular(SampleBlock& block) {
  if (block.samples < 2) {
    return;
  }
  const std::int64_t interval = block.stamps_ns[1] - block.stamps_ns[0];
  for (std::size_t i = 2; i < block.samples; ++i) {
    if (block.stamps_ns[i] - block.stamps_ns[i - 1] != interval) {
      return;
    }
  }
  std::int64_t since_origin = 0;
  std::int64_t origin = 0;
  if (__builtin_mul_overflow(block.first_sample, interval, &since_origin) ||
      __builtin_sub_overflow(block.stamps_ns[0], since_origin, &origin)) {
    return;
  }
  block.clock = RegularClock{origin, interval, 1};
  block.stamps_ns.clear();
}

} // namespace

Expected<std::unique_ptr<CsvReader>> CsvReader::open(const FileSettings& settings) {
  std::unique_ptr<CsvReader> reader(new CsvReader(settings));
  reader->file_.open(settings.path, std::ios::binary);
  if (!reader->file_ || !std::filesystem::is_regular_file(settings.path)) {
    return tl::unexpected(
        Error{ErrorCode::not_found, settings.path.string() + ": cannot read this file; does it exist, and may you read it?"});
  }
  if (auto header = reader->read_header(); !header) {
    return tl::unexpected(header.error());
  }
  return reader;
}

tl::unexpected<Error> CsvReader::malformed(const std::string& problem) const {
  return tl::unexpected(Error{ErrorCode::malformed, settings_.path.string() + ":" + std::to_string(line_number_) + ": " + problem});
}

Expected<void> CsvReader::read_header() {
  ++line_number_;
  if (!std::getline(file_, line_)) {
    return malformed("the file is empty; its first line must name the columns");
  }
  separator_ = separator_of(line_);
  std::vector<std::string> names;
  std::string_view rest = line_;
  std::string_view field;
  for (bool more = true; next_field(rest, more, separator_, field);) {
    if (field.size() > 1 && field.front() == '"' && field.back() == '"') {
      field = field.substr(1, field.size() - 2);
    }
    names.emplace_back(field);
  }
  return name_columns(names);
}

Expected<void> CsvReader::name_columns(const std::vector<std::string>& names) {
  columns_ = names;
  std::vector<std::string> channels;
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (name->empty() || is_number(*name)) {
      return malformed("column " + std::to_string(name - names.begin() + 1) + " has no name; the first line must name the columns");
    }
    if (std::find(names.begin(), name, *name) != name) {
      return malformed("two columns are called '" + *name + "'");
    }
    const bool time = *name == "t_ns";
    const bool sample_number = *name == "sample_number";
    has_time_ = has_time_ || time;
    has_number_ = has_number_ || sample_number;
    meanings_.push_back(time ? Meaning::time : sample_number ? Meaning::number : Meaning::channel);
    if (meanings_.back() == Meaning::channel) {
      channels.push_back(*name);
    }
  }
  if (!has_time_ && !settings_.sample_rate) {
    return tl::unexpected(Error{ErrorCode::invalid_setting,
                                settings_.path.string() + ": no column t_ns and no sample_rate_hz; one of them must tell the time"});
  }
  auto described = describe_file_channels(settings_, channels);
  if (!described) {
    return tl::unexpected(described.error());
  }
  description_ = *described;
  row_.values.resize(channels.size());
  return {};
}

tl::unexpected<Error> CsvReader::wrong_field(std::string_view field, std::size_t column, const char* wanted) const {
  return malformed("'" + std::string(field.substr(0, 40)) + "' in column " + columns_[column] + " is not " + wanted);
}

template <class Number>
Expected<Number> CsvReader::number(std::string_view field, std::size_t column) const {
  Number value{};
  if (!field.empty() && field.front() == '+') {
    field.remove_prefix(1);
  }
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (status != std::errc() || end != field.data() + field.size()) {
    return wrong_field(field, column, std::is_integral_v<Number> ? "a whole number" : "a number");
  }
  return value;
}

Expected<void> CsvReader::parse_row(std::string_view line) {
  std::string_view field;
  std::size_t column = 0;
  std::size_t channel = 0;
  for (bool more = true; next_field(line, more, separator_, field); ++column) {
    if (column == columns_.size()) {
      return malformed("more fields than the first line has columns (" + std::to_string(columns_.size()) + ")");
    }
    if (meanings_[column] == Meaning::channel) {
      if (field.empty()) {
        row_.values[channel++] = std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      const auto value = number<double>(field, column);
      if (!value) {
        return tl::unexpected(value.error());
      }
      row_.values[channel++] = *value;
    } else if (meanings_[column] == Meaning::time) {
      const auto value = number<std::int64_t>(field, column);
      if (!value) {
        return tl::unexpected(value.error());
      }
      row_.stamp_ns = *value;
    } else {
      const auto value = number<std::uint64_t>(field, column);
      if (!value) {
        return tl::unexpected(value.error());
      }
      row_.sample = *value;
    }
  }
  if (column != columns_.size()) {
    return malformed(std::to_string(column) + " fields, but the first line has " + std::to_string(columns_.size()) + " columns");
  }
  return {};
}

Expected<void> CsvReader::check_order(std::uint64_t sample_before, std::int64_t stamp_before) const {
  if (has_number_ && row_.sample <= sample_before) {
    return malformed("sample_number " + std::to_string(row_.sample) + " after " + std::to_string(sample_before) + "; it must rise");
  }
  if (has_time_ && row_.stamp_ns <= stamp_before) {
    return malformed("t_ns " + std::to_string(row_.stamp_ns) + " after " + std::to_string(stamp_before) + "; the stamps must rise");
  }
  return {};
}

Expected<bool> CsvReader::read_row() {
  const std::uint64_t sample_before = row_.sample;
  const std::int64_t stamp_before = row_.stamp_ns;
  do {
    ++line_number_;
    if (!std::getline(file_, line_)) {
      if (file_.bad()) {
        return malformed("the file cannot be read any further");
      }
      return false;
    }
  } while (trimmed(line_).empty());
  if (auto parsed = parse_row(line_); !parsed) {
    return tl::unexpected(parsed.error());
  }
  if (first_row_) {
    first_row_ = false;
    return true;
  }
  if (!has_number_) {
    row_.sample = sample_before + 1;
  }
  if (auto order = check_order(sample_before, stamp_before); !order) {
    return tl::unexpected(order.error());
  }
  return true;
}

Expected<SampleBlock> CsvReader::read(std::size_t samples) {
  SampleBlock block;
  std::vector<double> rows;
  const std::size_t channels = description_.channels.size();
  while (block.samples < samples) {
    if (!row_waits_) {
      const auto more = read_row();
      if (!more) {
        return tl::unexpected(more.error());
      }
      if (!*more) {
        break;
      }
    }
    if (block.samples == 0) {
      block.first_sample = row_.sample;
    }
    row_waits_ = row_.sample != block.first_sample + block.samples;
    if (row_waits_) {
      break;
    }
    rows.insert(rows.end(), row_.values.begin(), row_.values.end());
    if (has_time_) {
      block.stamps_ns.push_back(row_.stamp_ns);
    }
    ++block.samples;
  }
  block.values.resize(rows.size());
  for (std::size_t i = 0; i < block.samples; ++i) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      block.values[channel * block.samples + i] = rows[i * channels + channel];
    }
  }
  if (has_time_) {
    make_regular(block);
  } else {
    block.clock = settings_.sample_rate->clock(0);
  }
  return block;
}

} // namespace dyncal::drivers::acs
