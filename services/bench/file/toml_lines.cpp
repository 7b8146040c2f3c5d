#include "services/bench/file/toml_lines.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <regex>

#include <fmt/core.h>
#include <toml++/toml.h>

namespace dyncal::inline bench {
namespace {

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f;
}

// Text that would vanish or break a document.
bool is_printable(const std::string& text) {
  return std::none_of(text.begin(), text.end(), is_control);
}

bool is_blank(const std::string& text) {
  return text.find_first_not_of(" \t\n") == std::string::npos;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n");
  return first == std::string::npos
             ? std::string()
             : text.substr(first, text.find_last_not_of(" \t\n") - first + 1);
}

} // namespace

bool is_date(const std::string& text) {
  const std::string pattern = "0000-00-00";
  if (text.size() != pattern.size() ||
      !std::equal(text.begin(), text.end(), pattern.begin(),
                  [](char c, char p) { return p == '-' ? c == '-' : c >= '0' && c <= '9'; })) {
    return false;
  }
  const auto number = [&](std::size_t from, std::size_t digits) {
    return std::atoi(text.substr(from, digits).c_str());
  };
  return std::chrono::year_month_day{std::chrono::year{number(0, 4)},
                                     std::chrono::month{static_cast<unsigned>(number(5, 2))},
                                     std::chrono::day{static_cast<unsigned>(number(8, 2))}}
      .ok();
}

std::string date_rule(const std::string& text) {
  static const std::regex day_first(R"(\s*(\d{1,2})\.\s?(\d{1,2})\.\s?(\d{4})\s*)");
  std::smatch found;
  if (std::regex_match(text, found, day_first)) {
    const std::string date =
        fmt::format("{}-{:0>2}-{:0>2}", found[3].str(), found[2].str(), found[1].str());
    if (is_date(date)) {
      return fmt::format("must be written as {}", date);
    }
  }
  return "must be a date, year, month, day: for example 2026-03-01";
}

std::string required_line(TomlTable& table, const std::string& key) {
  const std::string text = table.required_text(key);
  if (!text.empty() && is_blank(text)) {
    table.refuse(key, "must not be empty");
  }
  if (!is_printable(text)) {
    table.refuse(key, "holds a control character");
  }
  return trimmed(text);
}

std::string line_of(TomlTable& table, const std::string& key) {
  const std::string text = table.text(key);
  if (!is_printable(text)) {
    table.refuse(key, "holds a control character");
  }
  return trimmed(text);
}

std::vector<std::string> lines_of(TomlTable& table, const std::string& key) {
  std::vector<std::string> lines;
  for (const std::string& text : table.texts(key)) {
    if (!is_printable(text)) {
      table.refuse(key, "holds a control character");
    }
    if (!is_blank(text)) {
      lines.push_back(trimmed(text));
    }
  }
  return lines;
}

std::string date_of(TomlTable& table, const std::string& key) {
  const toml::node* node = table.node(key);
  if (node == nullptr) {
    return {};
  }
  if (const auto date = node->value_exact<toml::date>()) {
    return fmt::format("{:04}-{:02}-{:02}", date->year, int{date->month}, int{date->day});
  }
  const std::string text = line_of(table, key);
  if (!is_date(text)) {
    table.refuse(key, fmt::format("is \"{}\" but {}", text, date_rule(text)));
  }
  return text;
}

} // namespace dyncal::inline bench
