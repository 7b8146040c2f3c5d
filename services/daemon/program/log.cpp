#include "services/daemon/program/log.hpp"

#include <pthread.h>

#include <csignal>
#include <cstdio>
#include <memory>
#include <mutex>

#include <spdlog/async.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/dist_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "services/base/printable_text.hpp"
#include "services/daemon/program/last_words.hpp"

namespace dyncal::inline daemon {

namespace {

constexpr std::size_t max_held_lines = 8192;
constexpr const char* pattern = "%Y-%m-%dT%H:%M:%S.%e %n %l: %v";

// Lines may hold what others have sent: it stays within its line, and steers no terminal.
class PrintableLines : public spdlog::formatter {
public:
  void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& text) override {
    const std::string shown = one_line({line.payload.data(), line.payload.size()});
    spdlog::details::log_msg shown_line = line;
    shown_line.payload = shown;
    pattern_.format(shown_line, text);
  }
  [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<PrintableLines>();
  }

private:
  spdlog::pattern_formatter pattern_{pattern};
};

// Standard error as the log's own thread writes it, with the number of lines that were discarded.
class CountingSink : public spdlog::sinks::base_sink<std::mutex> {
public:
  explicit CountingSink(const std::shared_ptr<spdlog::details::thread_pool>& queue)
      : queue_(queue) {}

private:
  void sink_it_(const spdlog::details::log_msg& line) override {
    spdlog::memory_buf_t text;
    formatter_->format(line, text);
    std::fwrite(text.data(), 1, text.size(), stderr);
    const auto queue = queue_.lock(); // nothing while the log is being finished
    const std::size_t discarded = queue ? queue->overrun_counter() : reported_;
    if (discarded > reported_) {
      std::fprintf(stderr, "%zu lines of the log were discarded\n", discarded - reported_);
      reported_ = discarded;
    }
  }
  void flush_() override { std::fflush(stderr); }

  const std::weak_ptr<spdlog::details::thread_pool> queue_;
  std::size_t reported_ = 0;
};

// Signals are for the thread that waits for them (stop_on_signals).
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

void use(std::shared_ptr<spdlog::logger> logger) {
  logger->set_formatter(std::make_unique<PrintableLines>());
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

// Further sinks may come and go while others log (log_file.hpp).
void write_at_once(const std::string& program) {
  auto sinks = std::make_shared<spdlog::sinks::dist_sink_mt>();
  sinks->add_sink(std::make_shared<spdlog::sinks::stderr_sink_mt>());
  use(std::make_shared<spdlog::logger>(program, std::move(sinks)));
}

} // namespace

void set_up_log(const std::string& program, LogWriting writing) {
  set_last_words(program);
  if (writing == LogWriting::at_once) {
    write_at_once(program);
    return;
  }
  spdlog::init_thread_pool(max_held_lines, 1, block_signals);
  use(std::make_shared<spdlog::async_logger>(
      program, std::make_shared<CountingSink>(spdlog::thread_pool()), spdlog::thread_pool(),
      spdlog::async_overflow_policy::overrun_oldest));
}

void finish_log() {
  if (!spdlog::thread_pool()) {
    return;
  }
  // Other threads may be in the middle of a line of the logger that they have.
  static std::shared_ptr<spdlog::logger> queued;
  queued = spdlog::default_logger();
  write_at_once(queued->name());
  // The queue is written by the end of its thread.
  spdlog::details::registry::instance().set_tp(nullptr);
}

} // namespace dyncal::inline daemon
