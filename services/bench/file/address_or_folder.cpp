#include "services/bench/file/address_or_folder.hpp"

#include <fmt/core.h>

namespace dyncal::inline bench {

void read_address_or_folder(TomlTable& table, NamedFiles& files, const char* what,
                            std::string& address, std::filesystem::path& path) {
  address = table.text("address");
  const std::string name = table.text("path");
  if (address.empty() == name.empty()) {
    table.refuse("address", fmt::format("or 'path' must be given, one of them: {}", what));
  }
  if (!name.empty()) {
    path = files.resolve(name);
  }
}

} // namespace dyncal::inline bench
