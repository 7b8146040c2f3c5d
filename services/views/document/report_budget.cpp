#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "services/base/rounding.hpp"
#include "services/contract/unit.hpp"
#include "services/views/document/html.hpp"
#include "services/views/document/report_sections.hpp"
#include "services/views/language/budget_sentences.hpp"
#include "services/views/language/contribution_name.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
constexpr double degrees_per_turn = 360.0;
constexpr double microseconds_per_second = 1e6;
constexpr double negligible = 0.01; // of u: a ten-thousandth of its square
constexpr const char* not_known = "–";

// The first valid result of every frequency: its budget stands for the others.
std::vector<StoredPoint> budget_points(const StoredResult& result, const std::string& channel) {
  std::vector<StoredPoint> chosen;
  for (StoredPoint& point : result.points_of(channel)) {
    const bool is_new = std::none_of(chosen.begin(), chosen.end(), [&](const StoredPoint& other) {
      return other.frequency_hz == point.frequency_hz && other.level_m_s2 == point.level_m_s2;
    });
    if (point.valid && is_new && !point.budget.empty()) {
      chosen.push_back(std::move(point));
    }
  }
  return chosen;
}

// Two digits, without an exponent where that is readable; nothing for what is not there.
std::string small_number(double value, Language language) {
  constexpr double smallest_plain = 1e-6;
  constexpr double smallest_short = 1e-3;
  if (!std::isfinite(value) || value == 0.0) {
    return value == 0.0 ? "0" : "";
  }
  if (std::abs(value) < smallest_plain || std::abs(value) >= smallest_short) {
    return decimal(language, rounded_uncertainty(value));
  }
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  return decimal(language, fmt::format("{:.{}f}", value, decimals));
}

std::string freedom_text(double degrees_of_freedom) {
  return std::isfinite(degrees_of_freedom) ? fmt::format("{:.0f}", degrees_of_freedom) : "∞";
}

double root_of_squares(const std::vector<double>& values) {
  return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0));
}

// One quantity of |H| or of its phase: relative or in radians, and in the quantity's own unit.
struct BudgetRow {
  std::string name{};
  std::string estimate{};
  std::string unit{};
  double u = 0.0; // in that unit
  std::string distribution{};
  double sensitivity = 0.0; // of H's unit, or degrees, to that unit
  double contribution = 0.0;
  double degrees_of_freedom = analysis::infinite_degrees_of_freedom;
};

// |H| = A_sensor / A_reference x response of the reference / response of the channel x factors
// of 1.
struct MagnitudeModel {
  double magnitude = 0.0;
  double level_m_s2 = StoredPoint::nan_value; // amplitude of the reference, as its channel reads
  double reference_response = 1.0;
  double channel_factor = 1.0; // 1 over the response of the channel
  std::string sensor_unit{};   // empty: not known

  [[nodiscard]] BudgetRow row_of(const Contribution& row, Language language) const;
};

bool acts_on(const Contribution& row, std::string_view subject) {
  return row.kind != ContributionKind::reference && row.subject == subject;
}

BudgetRow MagnitudeModel::row_of(const Contribution& row, Language language) const {
  BudgetRow shown{.name = contribution_name(row, language),
                  .distribution = std::string(name_of(row.distribution, language)),
                  .contribution = magnitude * row.u_magnitude_rel,
                  .degrees_of_freedom = row.degrees_of_freedom};
  const bool of_sensor = acts_on(row, "the sensor") || row.kind == ContributionKind::rice;
  const bool is_amplitude = std::isfinite(level_m_s2) && level_m_s2 > 0.0 &&
                            (acts_on(row, "the reference") || (of_sensor && !sensor_unit.empty()));
  double estimate = row.kind == ContributionKind::reference ? reference_response : 1.0;
  shown.unit = "1";
  if (is_amplitude) {
    estimate =
        of_sensor ? magnitude * level_m_s2 / (reference_response * channel_factor) : level_m_s2;
    shown.unit = of_sensor ? sensor_unit : "m/s²";
  }
  shown.estimate = decimal(language, fmt::format("{:.5g}", estimate));
  shown.u = estimate * row.u_magnitude_rel;
  shown.sensitivity = magnitude / estimate;
  return shown;
}

// arg H = phase of the sensor - phase of the reference + angles of 0 + 360 degrees f x delays of 0.
BudgetRow phase_row(const Contribution& row, double frequency_hz, Language language) {
  const double u_deg = degrees_per_radian * row.u_phase_rad;
  const bool is_delay = row.repeats == analysis::Repeats::common_delay;
  const double per_unit =
      is_delay ? degrees_per_turn * frequency_hz / microseconds_per_second : 1.0;
  return {.name = contribution_name(row, language),
          .estimate = "0",
          .unit = is_delay ? "µs" : "°",
          .u = u_deg / per_unit,
          .distribution = std::string(name_of(row.distribution, language)),
          .sensitivity = per_unit,
          .contribution = u_deg,
          .degrees_of_freedom = row.degrees_of_freedom};
}

std::vector<double> contributions_of(const std::vector<BudgetRow>& rows) {
  std::vector<double> contributions;
  contributions.reserve(rows.size());
  for (const BudgetRow& row : rows) {
    contributions.push_back(row.contribution);
  }
  return contributions;
}

// The large rows first, the smallest as one, and their sum.
std::string model_table(std::vector<BudgetRow> rows, const std::string& unit, Language language) {
  std::erase_if(rows, [](const BudgetRow& row) { return row.contribution == 0.0; });
  const double u = root_of_squares(contributions_of(rows));
  std::ranges::stable_sort(rows, std::ranges::greater(), &BudgetRow::contribution);
  const auto small = std::ranges::find_if(
      rows, [&](const BudgetRow& row) { return row.contribution < negligible * u; });
  const std::vector<BudgetRow> others(small, rows.end());
  rows.erase(small, rows.end());
  HtmlTable table("model",
                  {sentences::quantity(language), sentences::estimate(language),
                   sentences::unit_of_quantity(language), sentences::standard_uncertainty(language),
                   sentences::distribution(language), sentences::sensitivity_coefficient(language),
                   fmt::format("{}{}", sentences::contribution.in(language),
                               unit.empty() ? "" : "&nbsp;/&nbsp;" + escaped(unit)),
                   sentences::degrees_of_freedom(language)});
  for (const BudgetRow& row : rows) {
    table.row({row.name, row.estimate, row.unit, small_number(row.u, language), row.distribution,
               decimal(language, fmt::format("{:.4g}", row.sensitivity)),
               small_number(row.contribution, language), freedom_text(row.degrees_of_freedom)});
  }
  if (!others.empty()) {
    table.html_row({sentences::small_rows(language, others.size()), not_known, not_known, not_known,
                    not_known, not_known,
                    small_number(root_of_squares(contributions_of(others)), language), not_known});
  }
  table.html_row({fmt::format("<b>{}</b>", sentences::single_result.in(language)), "", "", "", "",
                  "<i>u</i> =", small_number(u, language), ""});
  return table.finish();
}

// U as it is certified, which the scatter of the repetitions is in.
std::string mean_line(const StatedValue& stated, const std::string& unit, const StoredValue& value,
                      Language language) {
  return element("p", sentences::expanded_of_mean(language, value.repetitions,
                                                  decimal(language, stated.expanded) +
                                                      (unit.empty() ? "" : " " + unit),
                                                  decimal(language, stated.k)));
}

// What calibrations are commonly compared at: 160 Hz, or what was measured nearest to it.
const StoredPoint& reference_point(const std::vector<StoredPoint>& points) {
  constexpr double reference_frequency_hz = 160.0;
  return *std::ranges::min_element(points, std::ranges::less(), [](const StoredPoint& point) {
    return std::abs(std::log(point.frequency_hz / reference_frequency_hz));
  });
}

// What a correction multiplies |H| by, at the step of a result; 1: it is not applied.
double applied_factor(const StoredResult& result, const StoredPoint& point,
                      const std::string& name) {
  for (const StoredStep& step : result.steps) {
    if (step.step != point.step || step.repetition != point.repetition) {
      continue;
    }
    for (const StoredCorrection& correction : step.corrections) {
      if (correction.name == name) {
        return correction.magnitude_factor.value_or(1.0);
      }
    }
  }
  return 1.0;
}

std::string unit_of_channel(const StoredResult& result, const std::string& channel) {
  const auto source = described_source(result, channel);
  if (!source) {
    return "";
  }
  for (const drivers::ChannelDescription& one : source->channels) {
    if (channel.ends_with("/" + one.name)) {
      const std::string unit = short_form(one.unit);
      return unit == "m/s^2" ? "m/s²" : unit;
    }
  }
  return "";
}

std::vector<Contribution> all_contributions(const std::vector<StoredPoint>& points,
                                            double Contribution::*u) {
  std::vector<Contribution> rows;
  for (const StoredPoint& point : points) {
    std::vector<double> all;
    all.reserve(point.budget.size());
    for (const Contribution& row : point.budget) {
      all.push_back(row.*u);
    }
    const double smallest_shown = negligible * root_of_squares(all);
    for (const Contribution& row : point.budget) {
      const bool is_known = std::ranges::any_of(
          rows, [&](const Contribution& other) { return other.name() == row.name(); });
      if (!is_known && row.*u >= smallest_shown && row.*u > 0.0) {
        rows.push_back(row);
      }
    }
  }
  return rows;
}

// Columns are contributions C1, C2, ...; what is small at every frequency is in one.
std::string frequency_table(const ReportContents& contents, const std::vector<StoredPoint>& points,
                            double Contribution::*u, double unit) {
  const Language language = contents.language;
  const std::vector<Contribution> rows = all_contributions(points, u);
  HtmlTable legend("legend",
                   {"", sentences::contribution(language), sentences::distribution(language),
                    sentences::in_repetitions(language), sentences::degrees_of_freedom(language)});
  std::vector<std::string> head{"<i>f</i> / Hz"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string number = fmt::format("C{}", i + 1);
    head.push_back(number);
    legend.row({number, contribution_name(rows[i], language),
                std::string(name_of(rows[i].distribution, language)),
                std::string(name_of(rows[i].repeats, language)),
                freedom_text(rows[i].degrees_of_freedom)});
  }
  head.push_back(sentences::others(language));
  head.emplace_back("<i>u</i>");
  HtmlTable table("budget", head);
  for (const StoredPoint& point : points) {
    std::vector<std::string> cells{place_cell(contents, point)};
    std::vector<double> all;
    std::vector<double> others;
    for (const Contribution& row : point.budget) {
      all.push_back(unit * row.*u);
      if (std::ranges::find(rows, row.name(), &Contribution::name) == rows.end()) {
        others.push_back(unit * row.*u);
      }
    }
    for (const Contribution& column : rows) {
      const auto found = std::ranges::find(point.budget, column.name(), &Contribution::name);
      cells.push_back(found == point.budget.end() ? ""
                                                  : small_number(unit * (*found).*u, language));
    }
    cells.push_back(small_number(root_of_squares(others), language));
    cells.push_back(small_number(root_of_squares(all), language));
    table.row(cells);
  }
  return legend.finish() + table.finish();
}

} // namespace

std::string budget_section(const ReportContents& contents, const std::string& channel) {
  const Language language = contents.language;
  const std::vector<StoredPoint> points = budget_points(contents.result, channel);
  if (points.empty()) {
    return "";
  }
  const StoredPoint& point = reference_point(points);
  const std::vector<StoredValue> values = contents.result.values_of(channel);
  const auto value = std::ranges::find_if(values, [&](const StoredValue& one) {
    return one.frequency_hz == point.frequency_hz && one.level_m_s2 == point.level_m_s2;
  });
  const std::string ratio_unit = short_form(point.unit);
  const std::string unit = ratio_unit == "1" ? "" : ratio_unit;
  const MagnitudeModel model{
      .magnitude = point.magnitude,
      .level_m_s2 = point.measured_level_m_s2,
      .reference_response = applied_factor(contents.result, point, "reference_response"),
      .channel_factor = applied_factor(contents.result, point, "channel_response " + channel),
      .sensor_unit = unit_of_channel(contents.result, channel)};
  std::vector<BudgetRow> magnitudes;
  std::vector<BudgetRow> phases;
  for (const Contribution& row : point.budget) {
    magnitudes.push_back(model.row_of(row, language));
    phases.push_back(phase_row(row, point.frequency_hz, language));
  }
  std::string html =
      element("h3",
              sentences::budget_at(language, channel, decimal(language, point.frequency_text_hz),
                                   decimal(language, fmt::format("{:g}", point.level_m_s2)))) +
      element("p", sentences::budget_model, language) +
      element("h4", sentences::budget_magnitude, language) +
      model_table(std::move(magnitudes), unit, language);
  html += value == values.end() ? "" : mean_line(stated_magnitude(*value), unit, *value, language);
  html += element("h4", sentences::budget_phase, language) +
          model_table(std::move(phases), "°", language);
  html += value == values.end() ? "" : mean_line(stated_phase_deg(*value), "°", *value, language);
  return html;
}

std::string budget_annex(const ReportContents& contents) {
  const Language language = contents.language;
  std::string html;
  for (const std::string& channel : contents.channels) {
    const std::vector<StoredPoint> points = budget_points(contents.result, channel);
    if (points.empty()) {
      continue;
    }
    html += element("h3", sentences::budget_of(language, channel)) +
            fmt::format("<h4>{}</h4>\n", sentences::of_the_value.in(language)) +
            frequency_table(contents, points, &Contribution::u_magnitude_rel, 100.0) +
            fmt::format("<h4>{}</h4>\n", sentences::in_degrees.in(language)) +
            frequency_table(contents, points, &Contribution::u_phase_rad, degrees_per_radian);
  }
  return html.empty() ? ""
                      : element("h2", sentences::budget_annex, language) +
                            element("p", sentences::budget_note, language) + html;
}

} // namespace dyncal::inline views
