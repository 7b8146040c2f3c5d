#include "services/programs/web/run_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/core.h>

#include "services/records/run_folder/run_folder.hpp"

namespace dyncal::inline programs::web {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, const char*>, 11> media_types{
    {{".html", "text/html; charset=utf-8"},
     {".css", "text/css; charset=utf-8"},
     {".js", "text/javascript; charset=utf-8"},
     {".json", "application/json"},
     {".svg", "image/svg+xml"},
     {".csv", "text/csv; charset=utf-8"},
     {".toml", "text/plain; charset=utf-8"},
     {".txt", "text/plain; charset=utf-8"},
     {".png", "image/png"},
     {".pdf", "application/pdf"},
     {".xml", "application/xml"}}};

constexpr std::string_view unfinished_ending = ".part"; // of what is still being written

void add_files(const fs::path& folder, const std::string& prefix, int depth,
               std::vector<RunFile>& files) {
  std::error_code unknown;
  for (const auto& entry : fs::directory_iterator(folder, unknown)) {
    const std::string name = prefix + entry.path().filename().string();
    const fs::file_status status = entry.symlink_status(unknown);
    if (files.size() >= RunFiles::max_files) {
      return;
    }
    if (name.ends_with(unfinished_ending)) {
      continue;
    }
    if (fs::is_regular_file(status)) {
      files.push_back({name, entry.file_size(unknown), entry.path()});
    } else if (fs::is_directory(status) && depth > 0) {
      add_files(entry.path(), name + "/", depth - 1, files);
    }
  }
}

// Names from the network lead to no other folder.
bool is_plain(const std::string& name) {
  return !name.empty() && name.find('/') == std::string::npos &&
         name.find('\0') == std::string::npos && name.front() != '.';
}

} // namespace

std::vector<RunFile> RunFiles::files_of(const std::string& bench, const std::string& run) const {
  std::vector<RunFile> files;
  if (root_.empty() || !is_plain(bench) || run.empty()) {
    return files;
  }
  std::error_code unknown;
  const fs::path folder = find_run_folder(root_, bench, run);
  if (!folder.empty() && !fs::is_symlink(folder, unknown) &&
      !fs::is_symlink(folder.parent_path(), unknown)) {
    add_files(folder, "", 1, files);
  }
  std::ranges::sort(files, {}, &RunFile::name);
  return files;
}

std::optional<RunFile> RunFiles::find(const std::string& bench, const std::string& run,
                                      const std::string& name) const {
  const std::vector<RunFile> files = files_of(bench, run);
  const auto found = std::ranges::find(files, name, &RunFile::name);
  return found == files.end() ? std::nullopt : std::optional(*found);
}

std::optional<ServedFile> RunFiles::open(const RunFile& file) const {
  const fs::path root = fs::absolute(root_).lexically_normal();
  return open_beneath(root, file.path.lexically_relative(root).string(), Links::none);
}

std::string percent_encoded(const std::string& text) {
  std::string encoded;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    const bool is_plain_letter = (code < 128 && std::isalnum(code) != 0) ||
                                 std::string_view("-_.~").find(letter) != std::string_view::npos;
    encoded += is_plain_letter ? std::string(1, letter) : fmt::format("%{:02X}", code);
  }
  return encoded;
}

std::string media_type(const std::string& name) {
  for (const auto& [ending, type] : media_types) {
    if (name.ends_with(ending)) {
      return type;
    }
  }
  return "application/octet-stream";
}

} // namespace dyncal::inline programs::web
