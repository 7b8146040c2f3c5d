// The files of runs, for downloads: what lies in a run folder, and nothing else of the disk.
//
// Only names that files_of() lists are opened: regular files of the folder and its folders (of
// depth 2). No symbolic link is followed below the root, be it a bench, a run or a file. Any
// thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/programs/web/served_file.hpp"

namespace dyncal::inline programs::web {

struct RunFile {
  std::string name; // "result.json", "figures/magnitude.svg"
  std::uintmax_t bytes = 0;
  std::filesystem::path path;
};

class RunFiles {
public:
  static constexpr std::size_t max_files = 1000; // of a run

  // Empty: there are no run folders.
  explicit RunFiles(std::filesystem::path root) : root_(std::move(root)) {}

  // By name.
  [[nodiscard]] std::vector<RunFile> files_of(const std::string& bench,
                                              const std::string& run) const;
  [[nodiscard]] std::optional<RunFile> find(const std::string& bench, const std::string& run,
                                            const std::string& name) const;

  // Nothing: it is not there any more, or by a link.
  [[nodiscard]] std::optional<ServedFile> open(const RunFile& file) const;

private:
  std::filesystem::path root_;
};

// As it stands in an address: every byte but letters, digits and -_.~ as %XX.
[[nodiscard]] std::string percent_encoded(const std::string& text);
// By the end of its name; "application/octet-stream" otherwise.
[[nodiscard]] std::string media_type(const std::string& name);

} // namespace dyncal::inline programs::web
