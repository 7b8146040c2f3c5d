#include "drivers/tables/table_files.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/core.h>

namespace dyncal::drivers::tables {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_bytes = 16'000'000;

Expected<std::vector<fs::path>> files_of(const TableSettings& settings) {
  std::error_code unknown;
  if (settings.paths.size() != 1 || !fs::is_directory(settings.paths.front(), unknown)) {
    return settings.paths;
  }
  const fs::path& folder = settings.paths.front();
  std::error_code failed;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    if (entry->is_regular_file(unknown) && !entry->path().filename().string().starts_with('.')) {
      files.push_back(entry->path());
    }
  }
  if (failed) {
    return fail(ErrorCode::not_found, fmt::format("{}: the folder cannot be read: {}",
                                                  folder.string(), failed.message()));
  }
  std::ranges::sort(files);
  return files;
}

Expected<std::string> text_of(const fs::path& path) {
  std::error_code failed;
  const bool is_file = fs::is_regular_file(path, failed);
  const std::uintmax_t bytes = is_file ? fs::file_size(path, failed) : 0;
  std::ifstream file(path, std::ios::binary);
  if (!is_file || failed || !file) {
    return fail(
        ErrorCode::not_found,
        fmt::format("{}: the table cannot be read: it is no file, or not there", path.string()));
  }
  if (bytes > max_bytes) {
    return fail(ErrorCode::not_found,
                fmt::format("{}: {} bytes are no table of steps", path.string(), bytes));
  }
  return std::string{std::istreambuf_iterator<char>(file), {}};
}

} // namespace

Expected<std::vector<TableFile>> read_table_files(const TableSettings& settings, TableIs is) {
  DYNCAL_TRY(const auto paths, files_of(settings));
  if (paths.empty() && is == TableIs::whole) {
    return fail(ErrorCode::not_found,
                fmt::format("{}: the folder holds no table", settings.paths.front().string()));
  }
  std::vector<TableFile> files;
  for (const fs::path& path : paths) {
    std::error_code unknown;
    if (is == TableIs::written_to && !fs::exists(path, unknown)) {
      continue;
    }
    DYNCAL_TRY(const auto text, text_of(path));
    DYNCAL_TRY(auto rows, parse_reference_table(path.string(), text, settings.format, is));
    files.push_back({path.string(), std::move(rows)});
  }
  return files;
}

} // namespace dyncal::drivers::tables
