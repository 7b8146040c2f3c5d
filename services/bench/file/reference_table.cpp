#include "services/bench/file/reference_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/core.h>

namespace dyncal::inline bench {
namespace {

using analysis::ReferenceCalibrationPoint;
using analysis::ReferenceContribution;

enum class Quantity { frequency, level, magnitude, phase, u_magnitude, u_phase, freedom, coverage };

enum class PhaseUnit { angle, delay }; // a delay d is the phase -2 pi f d

// What values of a column may be, and what others suggest.
struct ColumnRule {
  const char* name;
  Quantity quantity;
  double least;
  double most;
  const char* hint;
  double factor = 1.0; // to the unit that is kept
  bool expanded = false;
  bool absolute = false; // in the unit of the magnitude
  PhaseUnit phase_unit = PhaseUnit::angle;
};

constexpr double infinite = analysis::infinite_degrees_of_freedom;
constexpr double pi = std::numbers::pi;
constexpr double rad_per_deg = pi / 180.0;
constexpr double per_percent = 0.01;
constexpr double most_u_rel = 0.5;
constexpr double least_ratio = 0.5; // of what a channel reads to what is
constexpr double most_ratio = 2.0;
constexpr const char* of_magnitude = "a part of the magnitude; is it given in per cent?";
constexpr const char* in_percent = "in per cent of the magnitude";
constexpr const char* in_its_unit = "in the unit of the magnitude";
constexpr const char* in_rad = "in rad; is it given in degrees?";
constexpr const char* in_deg = "in degrees";
constexpr const char* in_s = "in seconds; is it given in microseconds?";
constexpr double most_delay_s = 1.0;
constexpr std::array rules{
    ColumnRule{"frequency_hz", Quantity::frequency, 1e-6, 1e9, "in Hz"},
    ColumnRule{"level_m_s2", Quantity::level, 0.0, 1e9, "in m/s^2"},
    ColumnRule{"magnitude", Quantity::magnitude, 1e-12, 1e12, "above 0"},
    ColumnRule{"phase_rad", Quantity::phase, -2.0 * pi, 2.0 * pi, in_rad},
    ColumnRule{"phase_deg", Quantity::phase, -360.0, 360.0, in_deg, rad_per_deg},
    ColumnRule{"delay_s", Quantity::phase, -most_delay_s, most_delay_s, in_s, 1.0, false, false,
               PhaseUnit::delay},
    ColumnRule{"u_magnitude_rel", Quantity::u_magnitude, 0.0, most_u_rel, of_magnitude},
    ColumnRule{"U_magnitude_rel", Quantity::u_magnitude, 0.0, most_u_rel, of_magnitude, 1.0, true},
    ColumnRule{"u_magnitude_percent", Quantity::u_magnitude, 0.0, 50.0, in_percent, per_percent},
    ColumnRule{"U_magnitude_percent", Quantity::u_magnitude, 0.0, 50.0, in_percent, per_percent,
               true},
    ColumnRule{"u_magnitude", Quantity::u_magnitude, 0.0, 1e12, in_its_unit, 1.0, false, true},
    ColumnRule{"U_magnitude", Quantity::u_magnitude, 0.0, 1e12, in_its_unit, 1.0, true, true},
    ColumnRule{"u_phase_rad", Quantity::u_phase, 0.0, pi / 2.0, in_rad},
    ColumnRule{"U_phase_rad", Quantity::u_phase, 0.0, pi / 2.0, in_rad, 1.0, true},
    ColumnRule{"u_phase_deg", Quantity::u_phase, 0.0, 90.0, in_deg, rad_per_deg},
    ColumnRule{"U_phase_deg", Quantity::u_phase, 0.0, 90.0, in_deg, rad_per_deg, true},
    ColumnRule{"u_delay_s", Quantity::u_phase, 0.0, most_delay_s, in_s, 1.0, false, false,
               PhaseUnit::delay},
    ColumnRule{"U_delay_s", Quantity::u_phase, 0.0, most_delay_s, in_s, 1.0, true, false,
               PhaseUnit::delay},
    ColumnRule{"degrees_of_freedom", Quantity::freedom, 1e-3, infinite,
               "a number, \"infinite\" or nothing"},
    ColumnRule{"k", Quantity::coverage, 1.0, 15.0, "the coverage factor of columns U_..."}};

constexpr bool may_be_of_contribution(Quantity quantity) {
  return quantity == Quantity::u_magnitude || quantity == Quantity::u_phase ||
         quantity == Quantity::freedom;
}

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

class Table {
public:
  Table(const ReferenceTableSettings& settings, std::string name)
      : settings_(settings), name_(std::move(name)) {}

  Expected<ReferenceTable> read(std::string_view text);

private:
  [[nodiscard]] tl::unexpected<Error> refuse(std::size_t column, const std::string& what) const {
    return fail(ErrorCode::bad_file, fmt::format("{}:{}:{}: {}", name_, line_, column, what));
  }
  Expected<void> read_header(std::string_view line);
  Expected<Column> column_of(const Field& field);
  [[nodiscard]] bool has(Quantity quantity) const;
  [[nodiscard]] bool has_expanded() const;
  [[nodiscard]] Expected<double> value_of(const Column& column, const Field& field) const;
  // The value of the first column of this quantity.
  [[nodiscard]] double first(Quantity quantity, const std::vector<double>& values,
                             double otherwise) const;
  [[nodiscard]] double phase_in(const std::vector<double>& values, double frequency_hz) const;
  [[nodiscard]] Expected<ReferenceCalibrationPoint> point_of(std::string_view line) const;
  [[nodiscard]] Expected<void> add_whole(const ReferenceContribution& whole,
                                         ReferenceCalibrationPoint& point) const;

  ReferenceTableSettings settings_;
  std::string name_;
  std::size_t line_ = 0;
  char separator_ = ',';
  std::vector<Column> columns_;
  std::vector<std::string> contributions_;
  bool has_whole_ = false;
};

Expected<Column> Table::column_of(const Field& field) {
  const std::size_t dot = field.text.rfind('.');
  const bool named = dot != std::string_view::npos;
  const std::string_view quantity = named ? field.text.substr(dot + 1) : field.text;
  const auto* const rule = std::find_if(rules.begin(), rules.end(), [&](const ColumnRule& one) {
    return quantity == one.name && (!named || may_be_of_contribution(one.quantity));
  });
  if (rule == rules.end() || (named && dot == 0)) {
    return refuse(field.column,
                  fmt::format("column '{}' is not known; columns are frequency_hz, level_m_s2, "
                              "magnitude, phase_rad, phase_deg or delay_s, u_magnitude_rel, "
                              "u_phase_rad (or U_..., ..._percent, ..._deg, u_delay_s), "
                              "degrees_of_freedom, k, and the uncertainties of a contribution, "
                              "such as distortion.u_phase_rad",
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
  const auto other = std::find_if(columns_.begin(), columns_.end(), [&](const Column& one) {
    return one.rule->quantity == rule->quantity && one.contribution == column.contribution;
  });
  if (other != columns_.end()) {
    return refuse(field.column,
                  other->rule == rule
                      ? fmt::format("column '{}' is there twice", field.text)
                      : fmt::format("column '{}' says what '{}' says: leave one of them out",
                                    field.text, other->rule->name));
  }
  return column;
}

bool Table::has(Quantity quantity) const {
  return std::ranges::any_of(
      columns_, [&](const Column& column) { return column.rule->quantity == quantity; });
}

bool Table::has_expanded() const {
  return std::ranges::any_of(columns_, [](const Column& column) { return column.rule->expanded; });
}

Expected<void> Table::read_header(std::string_view line) {
  separator_ = line.find(';') == std::string_view::npos ? ',' : ';';
  for (const Field& field : fields_of(line, separator_)) {
    DYNCAL_TRY(const auto column, column_of(field));
    columns_.push_back(column);
    has_whole_ =
        has_whole_ || (!column.contribution && may_be_of_contribution(column.rule->quantity));
  }
  for (const Quantity needed : {Quantity::frequency, Quantity::magnitude}) {
    if (!has(needed)) {
      const auto* const rule = std::ranges::find(rules, needed, &ColumnRule::quantity);
      return refuse(
          1, fmt::format("column '{}' is missing; the first line names the columns", rule->name));
    }
  }
  if (has_expanded() && !has(Quantity::coverage) && !settings_.coverage_factor) {
    return refuse(1, "columns U_... are expanded uncertainties: name the coverage factor, k");
  }
  return {};
}

Expected<double> Table::value_of(const Column& column, const Field& field) const {
  const ColumnRule& rule = *column.rule;
  const bool freedom = rule.quantity == Quantity::freedom;
  if (freedom && (field.text.empty() || field.text == "infinite")) {
    return infinite;
  }
  const auto value = number_in(field.text, separator_);
  const bool is_ratio = rule.quantity == Quantity::magnitude && settings_.is_ratio;
  const char* hint =
      is_ratio ? "what the channel reads over what is, not a sensitivity" : rule.hint;
  if (!value) {
    return refuse(field.column,
                  fmt::format("'{}' is not a number; {} must be {}", field.text, rule.name, hint));
  }
  const double least = is_ratio ? least_ratio : rule.least;
  const double most = is_ratio ? most_ratio : rule.most;
  if (*value < least || *value > most || (!freedom && std::isinf(*value))) {
    return refuse(field.column,
                  fmt::format("{} = {} is not plausible: {}", rule.name, field.text, hint));
  }
  return *value * rule.factor;
}

// What the named contributions leave of the whole.
Expected<void> Table::add_whole(const ReferenceContribution& whole,
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
    return refuse(1, "the named contributions are larger than the whole uncertainty of magnitude "
                     "and phase; correct them, or leave the whole out");
  }
  rest.u_magnitude_rel =
      std::sqrt(std::max(0.0, whole.u_magnitude_rel * whole.u_magnitude_rel - magnitude2));
  rest.u_phase_rad = std::sqrt(std::max(0.0, whole.u_phase_rad * whole.u_phase_rad - phase2));
  point.contributions.push_back(rest);
  return {};
}

double Table::first(Quantity quantity, const std::vector<double>& values, double otherwise) const {
  const auto found = std::ranges::find_if(
      columns_, [&](const Column& column) { return column.rule->quantity == quantity; });
  return found == columns_.end() ? otherwise
                                 : values[static_cast<std::size_t>(found - columns_.begin())];
}

// Lead, whatever the column is.
double Table::phase_in(const std::vector<double>& values, double frequency_hz) const {
  const double stated = first(Quantity::phase, values, 0.0);
  const auto column = std::ranges::find_if(
      columns_, [](const Column& one) { return one.rule->quantity == Quantity::phase; });
  if (column != columns_.end() && column->rule->phase_unit == PhaseUnit::delay) {
    return -2.0 * pi * frequency_hz * stated;
  }
  return settings_.phase_is_lag ? -stated : stated;
}

Expected<ReferenceCalibrationPoint> Table::point_of(std::string_view line) const {
  const std::vector<Field> fields = fields_of(line, separator_);
  if (fields.size() != columns_.size()) {
    return refuse(fields.back().column, fmt::format("{} fields, but the header names {} columns",
                                                    fields.size(), columns_.size()));
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    DYNCAL_TRY(values.emplace_back(), value_of(columns_[i], fields[i]));
  }
  ReferenceCalibrationPoint point{.frequency_hz = first(Quantity::frequency, values, 0.0),
                                  .level_m_s2 = first(Quantity::level, values, 0.0),
                                  .magnitude = first(Quantity::magnitude, values, 1.0)};
  point.phase_rad = phase_in(values, point.frequency_hz);
  const double k = first(Quantity::coverage, values, settings_.coverage_factor.value_or(1.0));
  ReferenceContribution whole;
  for (const std::string& contribution : contributions_) {
    point.contributions.push_back({.name = contribution});
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ColumnRule& rule = *columns_[i].rule;
    ReferenceContribution& of =
        columns_[i].contribution ? point.contributions[*columns_[i].contribution] : whole;
    const double u = values[i] / (rule.expanded ? k : 1.0);
    if (rule.quantity == Quantity::u_magnitude) {
      of.u_magnitude_rel = rule.absolute ? u / point.magnitude : u;
    } else if (rule.quantity == Quantity::u_phase) {
      const bool is_delay = rule.phase_unit == PhaseUnit::delay;
      of.u_phase_rad = is_delay ? 2.0 * pi * point.frequency_hz * u : u;
      if (!(of.u_phase_rad <= pi / 2.0)) {
        return refuse(fields[i].column, fmt::format("{} = {} is more than a quarter of a period at "
                                                    "{} Hz",
                                                    rule.name, fields[i].text, point.frequency_hz));
      }
    } else if (rule.quantity == Quantity::freedom) {
      of.degrees_of_freedom = values[i];
    }
  }
  if (has_whole_) {
    DYNCAL_TRY(add_whole(whole, point));
  }
  return point;
}

// Certificates state the level of each frequency: where none is there twice, that is no second
// curve, and the values hold at other levels as well as a certificate of one level does.
void drop_lone_levels(std::vector<ReferenceCalibrationPoint>& points) {
  const bool is_one_curve = std::ranges::all_of(points, [&](const auto& point) {
    return std::ranges::count(points, point.frequency_hz,
                              &ReferenceCalibrationPoint::frequency_hz) == 1;
  });
  for (ReferenceCalibrationPoint& point : points) {
    point.level_m_s2 = is_one_curve ? 0.0 : point.level_m_s2;
  }
}

Expected<ReferenceTable> Table::read(std::string_view text) {
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
  drop_lone_levels(points);
  if (const auto valid = analysis::reference_response_at(points, points.front().frequency_hz,
                                                         points.front().level_m_s2);
      !valid) {
    return refuse(1, valid.error().message);
  }
  const bool phase_in_rad = std::ranges::any_of(columns_, [](const Column& column) {
    return column.rule->quantity == Quantity::phase && column.rule->factor == 1.0 &&
           column.rule->phase_unit == PhaseUnit::angle;
  });
  return ReferenceTable{std::move(points), phase_in_rad};
}

} // namespace

Expected<ReferenceTable> parse_reference_table(std::string_view text, const std::string& name,
                                               const ReferenceTableSettings& settings) {
  return Table(settings, name).read(text);
}

} // namespace dyncal::inline bench
