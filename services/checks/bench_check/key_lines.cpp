#include "services/checks/bench_check/key_lines.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline checks::bench_check {

std::string text_of(const KeyPath& path) {
  return fmt::format("{}", fmt::join(path, "."));
}

KeyLines::KeyLines(const std::string& bench_text) {
  if (auto parsed = parse_toml(bench_text, {})) {
    root_ = std::make_shared<const toml::table>(std::move(*parsed));
  }
}

std::optional<std::string> KeyLines::text_at(const KeyPath& path) const {
  const toml::node* node = root_.get();
  for (const std::string& name : path) {
    const toml::table* table = node != nullptr ? node->as_table() : nullptr;
    node = table != nullptr ? table->get(name) : nullptr;
  }
  return node != nullptr ? node->value<std::string>() : std::nullopt;
}

std::size_t KeyLines::line_of(const KeyPath& path, std::optional<std::size_t> entry) const {
  const toml::node* node = root_.get();
  if (node == nullptr) {
    return 1;
  }
  for (const std::string& name : path) {
    const toml::table* table = node->as_table();
    const toml::node* inner = table != nullptr ? table->get(name) : nullptr;
    if (inner == nullptr) {
      break;
    }
    node = inner;
  }
  if (const toml::array* list = node->as_array(); list != nullptr && entry) {
    node = list->get(*entry) != nullptr ? list->get(*entry) : node;
  }
  return std::max<std::size_t>(node->source().begin.line, 1);
}

} // namespace dyncal::inline checks::bench_check
