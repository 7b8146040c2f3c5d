// A file that is a whole MCAP recording after every single write, so that a program which is killed
// at any instant, or a disk that is full, never leaves one that readers refuse.
//
// Behind the sound data lies a filler record that reaches to the last 50 bytes of the file, which
// are the shortest end a recording has (DataEnd, Footer without summary, magic). append() writes
// what is new into the filler, where no reader looks, with another filler behind it, and then turns
// the filler's head into that of the first new record: nine bytes that never lie across two pages,
// which no kill divides. A larger filler begins with a new end of the file. finish() puts the real
// end in place and cuts the rest off. The room is not taken from the disk before it is used.
//
// Fails (bad_file) with the file and the reason; what was appended before is not touched by that,
// and append() may be tried again. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline records::recording {

class RecordingFile {
public:
  // `beginning`: magic and header. The file takes its name when it is whole; fails when one of this
  // name is there.
  [[nodiscard]] static base::Expected<RecordingFile> create(const std::filesystem::path& path,
                                                            std::string_view beginning);

  // Whole records in one piece or several, the first with at least a record's head. `crc`: of all
  // their bytes.
  [[nodiscard]] base::Expected<void> append(std::span<const std::string_view> parts,
                                            std::uint32_t crc);
  // DataEnd, summary, Footer and magic; then everything is on the disk.
  [[nodiscard]] base::Expected<void> finish(std::string_view ending);
  // Returns when everything so far is on the disk.
  [[nodiscard]] base::Expected<void> synchronise();

  // Where the next record will stand: so many bytes are sound.
  [[nodiscard]] std::uint64_t end() const { return end_; }
  // Of all bytes before end().
  [[nodiscard]] std::uint32_t crc() const { return crc_; }
  // Room on the disk, bytes.
  [[nodiscard]] std::uint64_t free_bytes() const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  RecordingFile(std::filesystem::path path, drivers::FileDescriptor file)
      : path_(std::move(path)), file_(std::move(file)) {}
  [[nodiscard]] base::Expected<void> begin(std::string_view beginning);
  [[nodiscard]] base::Expected<void> extend(std::uint64_t needed);
  [[nodiscard]] base::Expected<void> write(std::string_view bytes, std::uint64_t offset) const;

  std::filesystem::path path_;
  drivers::FileDescriptor file_;
  std::uint64_t end_ = 0;   // of the sound data: here stands the filler's head
  std::uint64_t limit_ = 0; // of the filler: here stands the end of the file
  std::uint32_t crc_ = 0;
};

} // namespace dyncal::inline records::recording
