// A large file written piece by piece, whole or not at all: it is NAME.part until finish(), which
// takes the name when everything is on the disk, and never replaces a file of that name unless it
// is made for that. Without finish() nothing is left.
//
// Fails (bad_file) with the file and the reason; a full disk shows in write() or finish(). One
// thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline base {

class OutputStream {
public:
  // Fails when a file or folder of that name is there.
  [[nodiscard]] static Expected<OutputStream> create(const std::filesystem::path& path);
  // An older file of that name is left as it is until finish().
  [[nodiscard]] static Expected<OutputStream> replace(const std::filesystem::path& path);
  OutputStream(OutputStream&& other) noexcept = default;
  OutputStream& operator=(OutputStream&&) = delete;
  ~OutputStream();

  [[nodiscard]] Expected<void> write(std::string_view bytes);
  // Over what was written before.
  [[nodiscard]] Expected<void> overwrite(std::uint64_t offset, std::string_view bytes);
  [[nodiscard]] Expected<void> finish();

  [[nodiscard]] std::uint64_t written() const { return written_; }
  // For libraries that write by themselves, until finish().
  [[nodiscard]] const std::filesystem::path& unfinished_path() const { return unfinished_; }
  [[nodiscard]] int descriptor() const { return file_.number(); }
  // The failure with the reason that `cause` (errno) has.
  [[nodiscard]] tl::unexpected<Error> not_written(int cause) const;

private:
  OutputStream(std::filesystem::path path, std::filesystem::path unfinished,
               drivers::FileDescriptor file)
      : path_(std::move(path)), unfinished_(std::move(unfinished)), file_(std::move(file)) {}
  [[nodiscard]] Expected<void> flush();

  std::filesystem::path path_;
  bool replaces_ = false;
  std::filesystem::path unfinished_;
  drivers::FileDescriptor file_; // closed: finished, or moved from
  std::string buffer_;           // the end of what was written
  std::uint64_t written_ = 0;
};

// A folder of files, whole or not at all: it is NAME.part until finish().
class OutputFolder {
public:
  // Fails when there is something of that name but an empty folder.
  [[nodiscard]] static Expected<OutputFolder> create(const std::filesystem::path& path);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();

  // Where its files are written.
  [[nodiscard]] const std::filesystem::path& unfinished_path() const { return unfinished_; }
  [[nodiscard]] Expected<void> finish();

private:
  OutputFolder(std::filesystem::path path, std::filesystem::path unfinished)
      : path_(std::move(path)), unfinished_(std::move(unfinished)) {}

  std::filesystem::path path_;
  std::filesystem::path unfinished_; // empty: finished, or moved from
};

// For what writes the file NAME.part by itself: that the name is free, and that it takes it.
// Replaces nothing but an empty folder.
[[nodiscard]] Expected<void> check_new_output(const std::filesystem::path& path);
[[nodiscard]] Expected<void> take_output_name(const std::filesystem::path& unfinished,
                                              const std::filesystem::path& path);
// All of the bytes, at `offset` of `file`; `path`: for the failure.
[[nodiscard]] Expected<void> write_at(const drivers::FileDescriptor& file, std::uint64_t offset,
                                      std::string_view bytes, const std::filesystem::path& path);
// The failure with the reason that `cause` (errno) has.
[[nodiscard]] tl::unexpected<Error> cannot_be_written(const std::filesystem::path& path, int cause);

} // namespace dyncal::inline base
