// A regular file in memory, read only, for as long as the object lives. The file must not shrink
// meanwhile. Any number of threads may read it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

#include "drivers/error.hpp"

namespace dyncal::drivers::files {

class MappedFile {
public:
  // Fails (not_found) with a sentence that names the file.
  [[nodiscard]] static Expected<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  [[nodiscard]] std::string_view text() const { return {static_cast<const char*>(data_), size_}; }

private:
  MappedFile() = default;
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

} // namespace dyncal::drivers::files
