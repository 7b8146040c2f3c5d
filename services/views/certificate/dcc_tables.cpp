#include "services/views/certificate/dcc_tables.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/contract/unit.hpp"

namespace dyncal::inline views {
namespace {

using Texts = std::vector<std::string>;

Texts words_of(const std::string& text) {
  std::istringstream stream(text);
  Texts words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

std::string joined_words(const std::string& text) {
  return fmt::format("{}", fmt::join(words_of(text), " "));
}

// Of the first descendant that has one of these names.
Texts words_in(const XmlElement& element, const std::vector<std::string_view>& names) {
  for (const std::string_view name : names) {
    for (const XmlElement& found : element.descendants(name, si_namespace)) {
      return words_of(found.text());
    }
  }
  return {};
}

void append(const Texts& texts, Texts& to) {
  to.insert(to.end(), texts.begin(), texts.end());
}

// Of a realListXMLList, or of a single si:real.
DccColumn column_of_list(const XmlElement& list) {
  DccColumn column;
  const Texts units = words_in(list, {"unitXMLList", "unit"});
  column.unit = units.empty() || std::ranges::count(units, units.front()) !=
                                     static_cast<std::ptrdiff_t>(units.size())
                    ? ""
                    : units.front();
  column.values = words_in(list, {"valueXMLList", "value"});
  column.uncertainties =
      words_in(list, {"valueExpandedMUXMLList", "valueExpandedMU", "valueStandardMUXMLList",
                      "valueStandardMU", "uncertaintyXMLList", "uncertainty"});
  column.coverage_factors = words_in(list, {"coverageFactorXMLList", "coverageFactor"});
  for (Texts* one : {&column.uncertainties, &column.coverage_factors}) {
    if (one->size() == 1) { // D-SI: it holds for all
      one->resize(column.values.size(), one->front());
    }
  }
  return column;
}

// A list of si:real, one a point.
DccColumn column_of_reals(const std::vector<XmlElement>& reals) {
  DccColumn column;
  for (const XmlElement& real : reals) {
    const DccColumn one = column_of_list(real);
    column.unit = column.values.empty() || column.unit == one.unit ? one.unit : "";
    append(one.values, column.values);
    append(one.uncertainties, column.uncertainties);
    append(one.coverage_factors, column.coverage_factors);
  }
  return column;
}

// Of the forms of a hybrid the one in this unit, else the first.
std::optional<DccColumn> column_of(const XmlElement& quantity, std::string_view unit) {
  std::optional<DccColumn> first;
  for (const XmlElement& list : quantity.descendants("realListXMLList", si_namespace)) {
    DccColumn column = column_of_list(list);
    if (!first || column.unit == unit) {
      first = std::move(column);
    }
  }
  if (!first) {
    if (const auto reals = quantity.descendants("real", si_namespace); !reals.empty()) {
      first = column_of_reals(reals);
    }
  }
  return first;
}

enum class Role { other, frequency, magnitude, phase, level };

bool holds(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

Role role_by_unit(const std::string& unit) {
  if (unit == R"(\hertz)") {
    return Role::frequency;
  }
  if (unit == R"(\degree)" || unit == R"(\radian)") {
    return Role::phase;
  }
  return holds(unit, R"(\coulomb)") || holds(unit, R"(\volt)") ? Role::magnitude : Role::other;
}

Role role_of(const XmlElement& quantity, const DccColumn& column) {
  const std::string type = quantity.attribute("refType");
  if (holds(type, "vibration_frequency")) {
    return Role::frequency;
  }
  if (holds(type, "vibration_accelerationAmplitude")) {
    return Role::level;
  }
  if (holds(type, "vibration_phase")) {
    return Role::phase;
  }
  if (holds(type, "vibration_magnitude")) {
    return Role::magnitude;
  }
  return role_by_unit(column.unit);
}

void add_quantity(const XmlElement& quantity, DccTable& table) {
  auto column = column_of(quantity, R"(\degree)");
  if (!column) {
    return;
  }
  const auto take = [&](DccColumn& place) {
    if (place.values.empty()) {
      place = std::move(*column);
    }
  };
  switch (role_of(quantity, *column)) {
  case Role::frequency:
    return take(table.frequency);
  case Role::magnitude:
    return take(table.magnitude);
  case Role::phase:
    return take(table.phase ? *table.phase : table.phase.emplace());
  case Role::level:
    return take(table.level ? *table.level : table.level.emplace());
  case Role::other:
    return;
  }
}

// What a table says beside it: levels, and comments on single points.
void add_meta_data(const XmlElement& data, DccTable& table) {
  for (const XmlElement& quantity : data.descendants("quantity", dcc_namespace)) {
    auto column = column_of(quantity, "");
    if (column && !table.level && role_of(quantity, *column) == Role::level) {
      table.level = std::move(column);
    }
  }
  if (!holds(data.attribute("refType"), "basic_tableRowComment")) {
    return;
  }
  const auto description = data.child("description");
  const auto valid = data.child("validXMLList");
  const Texts which = valid ? words_of(valid->text()) : Texts();
  Texts where;
  for (std::size_t i = 0; i < std::min(which.size(), table.frequency.values.size()); ++i) {
    if (which[i] == "true" || which[i] == "1") {
      where.push_back(table.frequency.values[i]);
    }
  }
  if (description && !where.empty()) {
    table.comments.push_back(
        fmt::format("at {} Hz: {}", fmt::join(where, ", "), english_text(*description)));
  }
}

DccTable table_of(const XmlElement& list) {
  DccTable table;
  for (const XmlElement& quantity : list.children("quantity")) {
    add_quantity(quantity, table);
  }
  for (const XmlElement& data : list.descendants("metaData", dcc_namespace)) {
    add_meta_data(data, table);
  }
  if (table.level && (table.level->values.size() != table.frequency.values.size() ||
                      !is_acceleration(table.level->unit))) {
    table.level.reset(); // it is no more than said
  }
  return table;
}

bool are_numbers(const Texts& texts) {
  return std::ranges::all_of(texts, [](const std::string& text) {
    double value = 0.0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    return status == std::errc{} && end == text.data() + text.size();
  });
}

// Of the same length everywhere, and numbers.
bool is_whole(const DccTable& table) {
  const std::size_t count = table.frequency.values.size();
  const auto fits = [&](const DccColumn& column) {
    return column.values.size() == count && are_numbers(column.values) &&
           (column.uncertainties.empty() || column.uncertainties.size() == count) &&
           are_numbers(column.uncertainties) &&
           (column.coverage_factors.empty() || column.coverage_factors.size() == count) &&
           are_numbers(column.coverage_factors);
  };
  return count > 0 && fits(table.frequency) && fits(table.magnitude) &&
         (!table.phase || fits(*table.phase)) && (!table.level || fits(*table.level));
}

} // namespace

std::string english_text(const XmlElement& element) {
  const std::vector<XmlElement> contents = element.children("content");
  if (contents.empty()) {
    return joined_words(element.text());
  }
  const auto english = std::ranges::find(
      contents, "en", [](const XmlElement& content) { return content.attribute("lang"); });
  return joined_words((english == contents.end() ? contents.front() : *english).text());
}

std::vector<DccTable> response_tables(const XmlElement& certificate) {
  std::vector<DccTable> tables;
  for (const XmlElement& result : certificate.descendants("result", dcc_namespace)) {
    for (const XmlElement& list : result.descendants("list", dcc_namespace)) {
      DccTable table = table_of(list);
      if (!is_whole(table)) {
        continue;
      }
      const auto name = list.child("name") ? list.child("name") : result.child("name");
      const std::string text = name ? english_text(*name) : "table";
      table.name = text;
      for (int number = 2; std::ranges::count(tables, table.name, &DccTable::name) > 0; ++number) {
        table.name = fmt::format("{} ({})", text, number);
      }
      tables.push_back(std::move(table));
    }
  }
  return tables;
}

} // namespace dyncal::inline views
