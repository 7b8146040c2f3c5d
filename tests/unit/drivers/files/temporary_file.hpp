// A file that is gone after the test.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace dyncal::drivers::files {

class TemporaryFile {
public:
  explicit TemporaryFile(const std::string& name, const std::string& text = "")
      : path_(std::filesystem::temp_directory_path() /
              ("dyncal_acs_test_" + std::to_string(getpid()) + "_" + name)) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

} // namespace dyncal::drivers::files
