// Names of benches and sources: keys of the contract, so they are short and plain.
#pragma once

#include <string>

#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// Refuses a name that is too long or has other characters than letters, digits, '-', '_' and '.'.
void check_name(TomlTable& table, const std::string& key, const std::string& name);

} // namespace dyncal::inline bench
