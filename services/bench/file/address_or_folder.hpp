// Keys `address` and `path` of sources of triggered records: a device, or a folder of its files.
#pragma once

#include <filesystem>
#include <string>

#include "services/bench/file/named_files.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// One of the two must be given; `what` explains them. `path` is looked up in `files`.
void read_address_or_folder(TomlTable& table, NamedFiles& files, const char* what,
                            std::string& address, std::filesystem::path& path);

} // namespace dyncal::inline bench
