// How laboratory and sensor file are read: table by table, each by a function of its own. Any
// thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "services/base/error.hpp"
#include "services/bench/file/toml_table.hpp"
#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline views {

// What `read` makes of the table [key]; `target` stays where there is none.
template <class Target, class Item>
void read_table(TomlTable& root, const std::string& key, Item (*read)(TomlTable&), Target& target) {
  if (auto table = root.table(key)) {
    target = read(*table);
    table->finish();
  }
}

// The tables [[key]], each read by `read` and finished.
template <class Item>
[[nodiscard]] std::vector<Item> read_tables_of(TomlTable& table, const std::string& key,
                                               const std::string& file, BenchProblems& problems,
                                               Item (*read)(TomlTable&)) {
  std::vector<Item> items;
  const toml::node* node = table.node(key);
  if (node == nullptr) {
    return items;
  }
  const toml::array* list = node->as_array();
  if (list == nullptr || !list->is_homogeneous(toml::node_type::table)) {
    table.refuse(key, "must be a list of tables, each begun by [[" + key + "]]");
    return items;
  }
  for (const toml::node& one : *list) {
    TomlTable inner(*one.as_table(), key, file, problems);
    items.push_back(read(inner));
    inner.finish();
  }
  return items;
}

// Of a whole file: what `read` makes of its tables, or the first of the problems that it finds.
template <class File>
[[nodiscard]] Expected<File>
parse_tables(std::string_view text, const std::filesystem::path& path,
             File (*read)(const toml::table&, const std::filesystem::path&, BenchProblems&)) {
  const auto parsed = parse_toml(text, path);
  if (!parsed) {
    return fail(ErrorCode::bad_file, parsed.error().text());
  }
  BenchProblems problems;
  File file = read(*parsed, path, problems);
  return problems.empty() ? Expected<File>(std::move(file))
                          : fail(ErrorCode::bad_file, problems.front().text());
}

} // namespace dyncal::inline views
