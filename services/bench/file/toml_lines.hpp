// Texts and days that documents print, from the tables of TOML files. Texts are UTF-8 without
// control characters but line breaks; what cannot be is refused in the table. Any thread.
#pragma once

#include <string>
#include <vector>

#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// Like TomlTable::required_text() and text(), and refuses control characters.
[[nodiscard]] std::string required_line(TomlTable& table, const std::string& key);
[[nodiscard]] std::string line_of(TomlTable& table, const std::string& key);
[[nodiscard]] std::vector<std::string> lines_of(TomlTable& table, const std::string& key);

// YYYY-MM-DD, and a day that there is.
[[nodiscard]] bool is_date(const std::string& text);

// What a text that is no date must be: a day as people write it is turned into that form.
[[nodiscard]] std::string date_rule(const std::string& text);

// YYYY-MM-DD, from a text or a date of TOML; empty if it is not there.
[[nodiscard]] std::string date_of(TomlTable& table, const std::string& key);

} // namespace dyncal::inline bench
