// Writes a ZIP archive of uncompressed files, as numpy.load() and every unzip program read it; of
// any size (ZIP64).
//
// Each entry stands in the file as it is: a head with its size and CRC-32, which are filled in when
// the entry ends, then its bytes; the directory of all entries follows the last one. Fails
// (bad_file) as OutputStream does. One thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/output_stream.hpp"

namespace dyncal::inline records {

class ZipFile {
public:
  [[nodiscard]] static Expected<ZipFile> create(const std::filesystem::path& path);

  // Ends the entry before.
  [[nodiscard]] Expected<void> begin_entry(const std::string& name);
  // REQUIRES: an entry was begun.
  [[nodiscard]] Expected<void> write(std::string_view bytes);
  [[nodiscard]] Expected<void> finish();

private:
  struct Entry {
    std::string name;
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
    std::uint32_t crc = 0;
  };

  explicit ZipFile(OutputStream file) : file_(std::move(file)) {}
  [[nodiscard]] Expected<void> end_entry();
  [[nodiscard]] static std::string head_of(const Entry& entry);
  [[nodiscard]] static std::string directory_entry_of(const Entry& entry);

  OutputStream file_;
  std::vector<Entry> entries_;
};

} // namespace dyncal::inline records
