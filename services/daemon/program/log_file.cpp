#include "services/daemon/program/log_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>

#include <fmt/core.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/dist_sink.h>
#include <spdlog/spdlog.h>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::inline daemon {
namespace {

constexpr const char* pattern = "%Y-%m-%dT%H:%M:%S.%e %n %l: %v";
constexpr mode_t for_everybody = 0666; // less what the umask takes

class FileSink : public spdlog::sinks::base_sink<std::mutex> {
public:
  explicit FileSink(drivers::FileDescriptor file) : file_(std::move(file)) {}

private:
  // One call a line: a program that is killed leaves whole lines.
  void sink_it_(const spdlog::details::log_msg& line) override {
    spdlog::memory_buf_t text;
    formatter_->format(line, text);
    static_cast<void>(::write(file_.number(), text.data(), text.size()) < 0);
  }
  void flush_() override {}

  drivers::FileDescriptor file_;
};

// Of a program that logs at once (log.hpp); nothing for others.
std::shared_ptr<spdlog::sinks::dist_sink_mt> sinks_of_program() {
  const auto& sinks = spdlog::default_logger()->sinks();
  return sinks.empty() ? nullptr
                       : std::dynamic_pointer_cast<spdlog::sinks::dist_sink_mt>(sinks.front());
}

} // namespace

struct LogFile::Sink {
  std::shared_ptr<FileSink> file;
  std::shared_ptr<spdlog::logger> own; // writes there alone
};

LogFile::LogFile(std::unique_ptr<Sink> sink) : sink_(std::move(sink)) {}
LogFile::LogFile(LogFile&&) noexcept = default;

LogFile::~LogFile() {
  if (const auto sinks = sink_ ? sinks_of_program() : nullptr) {
    sinks->remove_sink(sink_->file);
  }
}

Expected<LogFile> LogFile::open(const std::filesystem::path& path) {
  drivers::FileDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, for_everybody));
  if (!file.is_open()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be written ({})", path.string(), std::strerror(errno)));
  }
  auto sink = std::make_unique<Sink>();
  sink->file = std::make_shared<FileSink>(std::move(file));
  sink->file->set_pattern(pattern);
  sink->own = std::make_shared<spdlog::logger>(spdlog::default_logger()->name(), sink->file);
  if (const auto sinks = sinks_of_program()) {
    sinks->add_sink(sink->file);
  }
  return LogFile(std::move(sink));
}

void LogFile::write(const std::string& line) {
  sink_->own->info("{}", line);
}

} // namespace dyncal::inline daemon
