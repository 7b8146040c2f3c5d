// A file that takes the lines of the program's log while the object lives (of a program that logs
// at once, log.hpp), and lines of its own, each with its time. A line is written whole; a full disk
// costs lines, never the program. Any thread.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "services/base/error.hpp"

namespace dyncal::inline daemon {

class LogFile {
public:
  // Appends to what is there. Fails (bad_file) when the file cannot be opened.
  [[nodiscard]] static Expected<LogFile> open(const std::filesystem::path& path);
  ~LogFile();
  LogFile(LogFile&&) noexcept;
  LogFile& operator=(LogFile&&) = delete;
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  // Into the file alone.
  void write(const std::string& line);

private:
  struct Sink;
  explicit LogFile(std::unique_ptr<Sink> sink);

  std::unique_ptr<Sink> sink_;
};

} // namespace dyncal::inline daemon
