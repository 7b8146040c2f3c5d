#include "services/bench/file/named_files.hpp"

#include <algorithm>
#include <array>

namespace dyncal::inline bench {
namespace {

constexpr std::string_view outside = "outside";

bool is_of_run_folder(const std::string& first) {
  constexpr std::array own{copied_bench_file, result_file_name, log_file_name, figures_folder_name,
                           outside};
  // recording.mcap, recording-2.mcap, and files that are being written
  return first.starts_with("recording") || first.ends_with(".part") ||
         std::find(own.begin(), own.end(), first) != own.end();
}

} // namespace

std::filesystem::path place_of_copy(const std::string& name) {
  const std::filesystem::path plain = std::filesystem::path(name).lexically_normal();
  if (plain.is_absolute()) {
    return outside / ("root" / plain.relative_path());
  }
  const std::string first = plain.empty() ? std::string() : plain.begin()->string();
  if (first == "..") {
    std::filesystem::path place = outside;
    for (const std::filesystem::path& part : plain) {
      place /= part == ".." ? std::filesystem::path("up") : part;
    }
    return place;
  }
  return first == "." || is_of_run_folder(first) ? outside / ("here" / plain) : plain;
}

std::filesystem::path NamedFiles::resolve(const std::string& name) {
  const std::filesystem::path place =
      place_ == Place::copies && !name.empty() ? place_of_copy(name) : std::filesystem::path(name);
  NamedFile file{name, std::filesystem::absolute(folder_ / place).lexically_normal()};
  const bool known = std::any_of(all_.begin(), all_.end(),
                                 [&](const NamedFile& other) { return other.name == name; });
  if (!name.empty() && !known) {
    all_.push_back(file);
  }
  return file.path;
}

} // namespace dyncal::inline bench
