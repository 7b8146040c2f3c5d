// A folder of its own below TMPDIR, removed with all that is in it. Not thread-safe.
#pragma once

#include <filesystem>

namespace dyncal::inline base {

class TemporaryFolder {
public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  // Empty: none could be made.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

} // namespace dyncal::inline base
