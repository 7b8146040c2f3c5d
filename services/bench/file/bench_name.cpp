#include "services/bench/file/bench_name.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/core.h>

namespace dyncal::inline bench {

namespace {

constexpr std::size_t max_key = 64; // of the contract's key strings

} // namespace

void check_name(TomlTable& table, const std::string& key, const std::string& name) {
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  });
  if (!plain || name.size() > max_key) {
    table.refuse(
        key, fmt::format(
                 "is \"{}\" but a name may hold letters, digits, '-', '_' and '.', {} at the most",
                 name, max_key));
  }
}

} // namespace dyncal::inline bench
