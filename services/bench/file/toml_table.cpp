#include "services/bench/file/toml_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "services/base/nearest_name.hpp"

namespace dyncal::inline bench {
namespace {

constexpr std::size_t whole_key = std::numeric_limits<std::size_t>::max();

std::size_t line_of(const toml::source_region& region) {
  return std::max(region.begin.line, toml::source_index{1});
}

std::string unit_phrase(const std::string& unit) {
  return unit.empty() ? "a number" : fmt::format("a number in {}", unit);
}

std::string value_text(const toml::node& node) {
  if (const auto* list = node.as_array()) {
    std::string text;
    for (const toml::node& entry : *list) {
      text += (text.empty() ? "" : ", ") + value_text(entry);
    }
    return "[" + text + "]";
  }
  if (const auto number = node.is_number() ? node.value<double>() : std::nullopt) {
    return fmt::format("{}", *number);
  }
  std::ostringstream text;
  node.visit([&](const auto& value) {
    text << toml::default_formatter{value, toml::format_flags::quote_infinities_and_nans};
  });
  return text.str();
}

void add_lines(const toml::table& table, const std::string& prefix,
               const std::set<std::string>& left_out, std::map<std::string, std::string>& lines) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    if (left_out.contains(key)) {
      continue;
    }
    if (const toml::table* inner = node.as_table()) {
      add_lines(*inner, key + ".", left_out, lines);
    } else {
      lines.emplace(key, value_text(node));
    }
  }
}

} // namespace

TomlTable::TomlTable(const toml::table& table, std::string name, std::string file,
                     BenchProblems& problems)
    : table_(table), name_(std::move(name)), file_(std::move(file)), problems_(problems) {}

const toml::node* TomlTable::find(const std::string& key) {
  known_.insert(key);
  return table_.get(key);
}

const toml::node* TomlTable::node(const std::string& key) {
  tell(key, {});
  return find(key);
}

std::string TomlTable::full_name(const std::string& key) const {
  return name_.empty() ? key : name_ + "." + key;
}

void TomlTable::tell(const std::string& key, AskedKey what) const {
  if (AskedKeys* const listening = AskedKeys::listening()) {
    what.name = full_name(key);
    listening->add(std::move(what));
  }
}

bool TomlTable::has(const std::string& key) const {
  tell(key, {});
  return table_.contains(key);
}

const toml::source_region& TomlTable::region(const std::string& key) const {
  const toml::node* found = table_.get(key);
  return found != nullptr ? found->source() : table_.source();
}

std::string TomlTable::where(const std::string& key) const {
  return fmt::format("{}:{}", file_, line_of(region(key)));
}

void TomlTable::refuse(const std::string& key, const std::string& what) {
  if (!refused_.emplace(key, whole_key).second) {
    return;
  }
  if (table_.contains(key)) {
    problems_.push_back({file_, line_of(region(key)), full_name(key), what});
  } else {
    about_absent_keys_.emplace(key, what);
    absent_keys_.push_back(key);
  }
}

void TomlTable::refuse_entry(const std::string& key, std::size_t entry, const std::string& what) {
  if (refused_.contains({key, whole_key}) || !refused_.emplace(key, entry).second) {
    return;
  }
  const toml::node* found = table_.get(key);
  const toml::array* list = found != nullptr ? found->as_array() : nullptr;
  const toml::node* one = list != nullptr ? list->get(entry) : nullptr;
  problems_.push_back(
      {file_, line_of(one != nullptr ? one->source() : region(key)), full_name(key), what});
}

bool TomlTable::refused(const std::string& key) const {
  const auto found = refused_.lower_bound({key, 0});
  return found != refused_.end() && found->first == key;
}

std::string TomlTable::required_text(const std::string& key) {
  tell(key, {.type = "text"});
  if (find(key) == nullptr) {
    refuse(key, "is missing");
    return {};
  }
  std::string value = text(key);
  if (value.empty()) {
    refuse(key, "must not be empty");
  }
  return value;
}

std::string TomlTable::text(const std::string& key, const std::string& otherwise) {
  tell(key, {.type = "text", .value = otherwise.empty() ? "" : fmt::format("\"{}\"", otherwise)});
  const toml::node* found = find(key);
  if (found == nullptr) {
    return otherwise;
  }
  if (const auto value = found->value_exact<std::string>()) {
    return *value;
  }
  refuse(key, "must be text in quotes");
  return otherwise;
}

std::optional<double> TomlTable::optional_number(const std::string& key, const std::string& unit) {
  tell(key, {.type = "number", .unit = unit});
  const toml::node* found = find(key);
  if (found == nullptr) {
    return std::nullopt;
  }
  const auto value = found->is_number() ? found->value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value)) {
    refuse(key, fmt::format("must be {}", unit_phrase(unit)));
    return std::nullopt;
  }
  return value;
}

double TomlTable::number(const std::string& key, double otherwise, const std::string& unit) {
  tell(key, {.type = "number", .unit = unit, .value = fmt::format("{}", otherwise)});
  return optional_number(key, unit).value_or(otherwise);
}

int TomlTable::whole_number(const std::string& key, int otherwise, int least,
                            const std::string& unit) {
  tell(key, {.type = "whole number", .unit = unit, .value = fmt::format("{}", otherwise)});
  const toml::node* found = find(key);
  if (found == nullptr) {
    return otherwise;
  }
  const auto value = found->value_exact<std::int64_t>();
  if (!value || *value < least || *value > std::numeric_limits<int>::max()) {
    refuse(key, fmt::format("must be a whole number, {} or more", least));
    return otherwise;
  }
  return static_cast<int>(*value);
}

bool TomlTable::yes_no(const std::string& key, bool otherwise) {
  tell(key, {.type = "true or false", .value = otherwise ? "true" : "false"});
  const toml::node* found = find(key);
  if (found == nullptr) {
    return otherwise;
  }
  if (const auto value = found->value_exact<bool>()) {
    return *value;
  }
  refuse(key, "must be true or false");
  return otherwise;
}

std::vector<std::string> TomlTable::texts(const std::string& key) {
  tell(key, {.type = "list of texts"});
  std::vector<std::string> values;
  const toml::node* found = find(key);
  if (found == nullptr) {
    return values;
  }
  const toml::array* list = found->as_array();
  if (list == nullptr) {
    refuse(key, "must be a list of texts, for example [\"a\", \"b\"]");
    return values;
  }
  for (const toml::node& entry : *list) {
    const auto value = entry.value_exact<std::string>();
    if (!value) {
      refuse(key, "must be a list of texts in quotes, for example [\"a\", \"b\"]");
      return values;
    }
    values.push_back(*value);
  }
  return values;
}

std::vector<double> TomlTable::numbers(const std::string& key, const std::string& unit) {
  tell(key, {.type = "number or list of numbers", .unit = unit});
  const toml::node* found = find(key);
  if (found == nullptr) {
    return {};
  }
  if (found->is_number()) {
    return {number(key, 0.0, unit)};
  }
  std::vector<double> values;
  const toml::array* list = found->as_array();
  if (list != nullptr) {
    for (const toml::node& entry : *list) {
      const auto value = entry.is_number() ? entry.value<double>() : std::nullopt;
      if (!value || !std::isfinite(*value)) {
        break;
      }
      values.push_back(*value);
    }
  }
  if (list == nullptr || values.size() != list->size()) {
    refuse(key, fmt::format("must be {} or a list of them", unit_phrase(unit)));
    return {};
  }
  return values;
}

std::map<std::string, std::string> TomlTable::text_map(const std::string& key) {
  tell(key, {.type = "table of texts"});
  std::map<std::string, std::string> values;
  const toml::node* found = find(key);
  if (found == nullptr) {
    return values;
  }
  const toml::table* entries = found->as_table();
  if (entries == nullptr) {
    refuse(key, "must be a table, for example { Data_11 = \"sync\" }");
    return values;
  }
  for (const auto& [name, entry] : *entries) {
    const auto value = entry.value_exact<std::string>();
    if (!value || value->empty()) {
      refuse(key, fmt::format("must name a text for '{}'", name.str()));
      return values;
    }
    values.emplace(name.str(), *value);
  }
  return values;
}

std::map<std::string, double> TomlTable::number_map(const std::string& key) {
  tell(key, {.type = "table of numbers"});
  std::map<std::string, double> values;
  const toml::node* found = find(key);
  if (found == nullptr) {
    return values;
  }
  const toml::table* entries = found->as_table();
  if (entries == nullptr) {
    refuse(key, "must be a table of numbers, for example { sync = 2.0 }");
    return values;
  }
  for (const auto& [name, entry] : *entries) {
    const auto value = entry.value<double>();
    if (!entry.is_number() || !std::isfinite(*value)) {
      refuse(key, fmt::format("must give a number for '{}'", name.str()));
      return values;
    }
    values.emplace(name.str(), *value);
  }
  return values;
}

std::string TomlTable::one_of(const std::string& key, const std::vector<std::string>& words,
                              const std::string& otherwise) {
  tell(key, {.type = "text",
             .value = otherwise.empty() ? "" : fmt::format("\"{}\"", otherwise),
             .choices = words});
  if (!has(key) && otherwise.empty()) {
    refuse(key, fmt::format("is missing: one of {}", fmt::join(words, ", ")));
  }
  std::string value = text(key, otherwise);
  if (std::find(words.begin(), words.end(), value) == words.end()) {
    refuse(key, fmt::format("is \"{}\" but must be one of {}", value, fmt::join(words, ", ")));
  }
  return value;
}

std::optional<TomlTable> TomlTable::table(const std::string& key) {
  tell(key, {.type = "table"});
  const toml::node* found = find(key);
  if (found == nullptr) {
    return std::nullopt;
  }
  if (const toml::table* inner = found->as_table()) {
    return TomlTable(*inner, full_name(key), file_, problems_);
  }
  refuse(key, "must be a table");
  return std::nullopt;
}

std::vector<std::string> TomlTable::keys() const {
  tell("NAME", {.type = "table"}); // names that the file chooses
  std::vector<std::string> names;
  for (const auto& entry : table_) {
    names.emplace_back(entry.first.str());
  }
  return names;
}

std::string TomlTable::lines_without(const std::set<std::string>& keys) const {
  std::map<std::string, std::string> lines;
  add_lines(table_, "", keys, lines);
  std::string text;
  for (const auto& [key, value] : lines) {
    text += fmt::format("{} = {}\n", key, value);
  }
  return text;
}

void TomlTable::finish() {
  for (const auto& entry : table_) {
    const std::string key(entry.first.str());
    if (!known_.contains(key)) {
      const std::string hint = nearest_name(key, known_);
      refuse(key,
             hint.empty() ? "is not known" : fmt::format("is not known; did you mean '{}'?", hint));
      about_absent_keys_.erase(hint);
    }
  }
  for (const std::string& key : absent_keys_) {
    if (const auto about = about_absent_keys_.find(key); about != about_absent_keys_.end()) {
      problems_.push_back({file_, line_of(region(key)), full_name(key), about->second});
    }
  }
}

} // namespace dyncal::inline bench
