#include "services/bench/file/reference_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "services/base/whole_file.hpp"

namespace dyncal::inline bench {
namespace {

using analysis::ReferenceCalibrationPoint;
using analysis::ReferenceContribution;

enum class Quantity {
  frequency_hz,
  level_m_s2,
  magnitude,
  phase_rad,
  u_magnitude_rel,
  u_phase_rad,
  degrees_of_freedom
};

// What values of a column may be, and what others suggest.
struct ColumnRule {
  const char* name;
  Quantity quantity;
  bool of_contributions; // too
  double least;
  double most;
  const char* hint;
};

constexpr double infinite = analysis::infinite_degrees_of_freedom;
constexpr std::array rules{
    ColumnRule{"frequency_hz", Quantity::frequency_hz, false, 1e-6, 1e9, "in Hz"},
    ColumnRule{"level_m_s2", Quantity::level_m_s2, false, 0.0, 1e9, "in m/s^2"},
    ColumnRule{"magnitude", Quantity::magnitude, false, 0.5, 2.0,
               "what the channel reads over what is, not a sensitivity"},
    ColumnRule{"phase_rad", Quantity::phase_rad, false, -2.0 * std::numbers::pi,
               2.0 * std::numbers::pi, "in rad; is it given in degrees?"},
    ColumnRule{"u_magnitude_rel", Quantity::u_magnitude_rel, true, 0.0, 0.5,
               "a part of the magnitude; is it given in per cent?"},
    ColumnRule{"u_phase_rad", Quantity::u_phase_rad, true, 0.0, std::numbers::pi / 2.0,
               "in rad; is it given in degrees?"},
    ColumnRule{"degrees_of_freedom", Quantity::degrees_of_freedom, true, 1e-3, infinite,
               "a number, \"infinite\" or nothing"}};

struct Column {
  const ColumnRule* rule = nullptr;
  std::optional<std::size_t> contribution; // its number; without: of the whole
};

struct Field {
  std::string_view text;  // without blanks about it
  std::size_t column = 1; // in the line, from 1
};

std::vector<Field> fields_of(std::string_view line, char separator) {
  std::vector<Field> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    std::size_t first = begin;
    std::size_t last = end;
    const auto blank = [&](std::size_t at) { return line[at] == ' ' || line[at] == '\t'; };
    while (first < last && blank(first)) {
      ++first;
    }
    while (last > first && blank(last - 1)) {
      --last;
    }
    fields.push_back({line.substr(first, last - first), first + 1});
    begin = end + 1;
  }
  return fields;
}

// Beside semicolons a comma is that of the decimals, as Excel writes them in much of Europe.
std::optional<double> number_in(std::string_view given, char separator) {
  std::string text(given);
  if (separator == ';') {
    std::replace(text.begin(), text.end(), ',', '.');
  }
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size() || std::isnan(value)) {
    return std::nullopt;
  }
  return value;
}

class ReferenceTable {
public:
  explicit ReferenceTable(std::string name) : name_(std::move(name)) {}

  Expected<std::vector<ReferenceCalibrationPoint>> read(std::string_view text);

private:
  [[nodiscard]] tl::unexpected<Error> refuse(std::size_t column, const std::string& what) const {
    return fail(ErrorCode::bad_file, fmt::format("{}:{}:{}: {}", name_, line_, column, what));
  }
  Expected<void> read_header(std::string_view line);
  Expected<Column> column_of(const Field& field);
  [[nodiscard]] Expected<double> value_of(const Column& column, const Field& field) const;
  [[nodiscard]] Expected<ReferenceCalibrationPoint> point_of(std::string_view line) const;
  [[nodiscard]] Expected<void> add_whole(const ReferenceContribution& whole,
                                         ReferenceCalibrationPoint& point) const;

  std::string name_;
  std::size_t line_ = 0;
  char separator_ = ',';
  std::vector<Column> columns_;
  std::vector<std::string> contributions_;
  bool has_whole_ = false;
};

Expected<Column> ReferenceTable::column_of(const Field& field) {
  const std::size_t dot = field.text.rfind('.');
  const bool named = dot != std::string_view::npos;
  const std::string_view quantity = named ? field.text.substr(dot + 1) : field.text;
  const auto* const rule = std::find_if(rules.begin(), rules.end(), [&](const ColumnRule& one) {
    return quantity == one.name && (!named || one.of_contributions);
  });
  if (rule == rules.end() || (named && dot == 0)) {
    return refuse(field.column,
                  fmt::format("column '{}' is not known; columns are frequency_hz, level_m_s2, "
                              "magnitude, phase_rad, u_magnitude_rel, u_phase_rad, "
                              "degrees_of_freedom, and the last three of a contribution, such as "
                              "distortion.u_phase_rad",
                              field.text));
  }
  Column column{rule, std::nullopt};
  if (named) {
    const std::string contribution(field.text.substr(0, dot));
    const auto found = std::find(contributions_.begin(), contributions_.end(), contribution);
    column.contribution = static_cast<std::size_t>(found - contributions_.begin());
    if (found == contributions_.end()) {
      contributions_.push_back(contribution);
    }
  }
  const bool twice = std::any_of(columns_.begin(), columns_.end(), [&](const Column& other) {
    return other.rule == column.rule && other.contribution == column.contribution;
  });
  if (twice) {
    return refuse(field.column, fmt::format("column '{}' is there twice", field.text));
  }
  return column;
}

Expected<void> ReferenceTable::read_header(std::string_view line) {
  separator_ = line.find(';') == std::string_view::npos ? ',' : ';';
  for (const Field& field : fields_of(line, separator_)) {
    DYNCAL_TRY(const auto column, column_of(field));
    columns_.push_back(column);
    has_whole_ = has_whole_ || (!column.contribution && column.rule->of_contributions);
  }
  for (const Quantity needed : {Quantity::frequency_hz, Quantity::magnitude, Quantity::phase_rad}) {
    if (std::none_of(columns_.begin(), columns_.end(),
                     [&](const Column& column) { return column.rule->quantity == needed; })) {
      return refuse(1, fmt::format("column '{}' is missing; the first line names the columns",
                                   rules.at(static_cast<std::size_t>(needed)).name));
    }
  }
  return {};
}

Expected<double> ReferenceTable::value_of(const Column& column, const Field& field) const {
  const ColumnRule& rule = *column.rule;
  const bool freedom = rule.quantity == Quantity::degrees_of_freedom;
  if (freedom && (field.text.empty() || field.text == "infinite")) {
    return infinite;
  }
  const auto value = number_in(field.text, separator_);
  if (!value) {
    return refuse(field.column, fmt::format("'{}' is not a number; {} must be {}", field.text,
                                            rule.name, rule.hint));
  }
  if (*value < rule.least || *value > rule.most || (!freedom && std::isinf(*value))) {
    return refuse(field.column,
                  fmt::format("{} = {} is not plausible: {}", rule.name, field.text, rule.hint));
  }
  return *value;
}

// What the named contributions leave of the whole.
Expected<void> ReferenceTable::add_whole(const ReferenceContribution& whole,
                                         ReferenceCalibrationPoint& point) const {
  ReferenceContribution rest = whole;
  double magnitude2 = 0.0, phase2 = 0.0;
  for (const ReferenceContribution& one : point.contributions) {
    magnitude2 += one.u_magnitude_rel * one.u_magnitude_rel;
    phase2 += one.u_phase_rad * one.u_phase_rad;
  }
  constexpr double rounding = 1.005; // of what certificates print
  if (std::sqrt(magnitude2) > rounding * whole.u_magnitude_rel ||
      std::sqrt(phase2) > rounding * whole.u_phase_rad) {
    return refuse(1, "the named contributions are larger than the whole uncertainty, "
                     "u_magnitude_rel and u_phase_rad; correct them, or leave the whole out");
  }
  rest.u_magnitude_rel =
      std::sqrt(std::max(0.0, whole.u_magnitude_rel * whole.u_magnitude_rel - magnitude2));
  rest.u_phase_rad = std::sqrt(std::max(0.0, whole.u_phase_rad * whole.u_phase_rad - phase2));
  point.contributions.push_back(rest);
  return {};
}

Expected<ReferenceCalibrationPoint> ReferenceTable::point_of(std::string_view line) const {
  const std::vector<Field> fields = fields_of(line, separator_);
  if (fields.size() != columns_.size()) {
    return refuse(fields.back().column, fmt::format("{} fields, but the header names {} columns",
                                                    fields.size(), columns_.size()));
  }
  ReferenceCalibrationPoint point;
  ReferenceContribution whole;
  for (const std::string& contribution : contributions_) {
    point.contributions.push_back({.name = contribution});
  }
  for (std::size_t i = 0; i < fields.size(); ++i) {
    DYNCAL_TRY(const auto value, value_of(columns_[i], fields[i]));
    ReferenceContribution& of =
        columns_[i].contribution ? point.contributions[*columns_[i].contribution] : whole;
    const std::array<double*, rules.size()> places{
        &point.frequency_hz, &point.level_m_s2, &point.magnitude,      &point.phase_rad,
        &of.u_magnitude_rel, &of.u_phase_rad,   &of.degrees_of_freedom};
    *places.at(static_cast<std::size_t>(columns_[i].rule->quantity)) = value;
  }
  if (has_whole_) {
    DYNCAL_TRY(add_whole(whole, point));
  }
  return point;
}

Expected<std::vector<ReferenceCalibrationPoint>> ReferenceTable::read(std::string_view text) {
  std::vector<ReferenceCalibrationPoint> points;
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF"; // which Excel writes
  text.remove_prefix(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line_;
    if (!line.empty() && line.back() == '\r') {
      line.remove_suffix(1);
    }
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (columns_.empty()) {
      DYNCAL_TRY(read_header(line));
      continue;
    }
    DYNCAL_TRY(auto point, point_of(line));
    points.push_back(std::move(point));
  }
  if (points.empty()) {
    return refuse(1, "the file has no points");
  }
  if (const auto valid = analysis::reference_response_at(points, points.front().frequency_hz,
                                                         points.front().level_m_s2);
      !valid) {
    return refuse(1, valid.error().message);
  }
  return points;
}

} // namespace

Expected<std::vector<ReferenceCalibrationPoint>> parse_reference_file(std::string_view text,
                                                                      const std::string& name) {
  return ReferenceTable(name).read(text);
}

Expected<std::vector<ReferenceCalibrationPoint>>
read_reference_file(const std::filesystem::path& path) {
  constexpr std::uintmax_t max_bytes = 16U << 20U;
  DYNCAL_TRY(const auto text, read_whole_file(path, max_bytes));
  return parse_reference_file(text, path.string());
}

} // namespace dyncal::inline bench
