// What showing progress costs (services/command/work_progress.hpp): the same work, counted and
// shown on a terminal from its beginning, and without, in turns. Compared is the processor time,
// which other programs of the machine hardly change; the ratio is that of the medians.
//
//   progress_cost [--rounds 7] [--pieces 2000] [--max-ratio 1.1]
//
// Exit status 1 if a result differs in a bit, or the ratio is above the one given.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include <pty.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "services/command/work_progress.hpp"

namespace {

using namespace dyncal::services;

double cpu_s() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// A terminal that reads all that is shown.
class Terminal {
public:
  Terminal() {
    int slave = -1;
    if (openpty(&master_, &slave, nullptr, nullptr, nullptr) != 0) {
      throw std::runtime_error("there is no pseudo-terminal");
    }
    stream_ = fdopen(slave, "w");
    reader_ = std::jthread([this] {
      std::array<char, 512> piece{};
      ssize_t length = 0;
      while ((length = read(master_, piece.data(), piece.size())) > 0) {
        bytes_ += static_cast<std::size_t>(length);
      }
    });
  }
  ~Terminal() {
    if (reader_.joinable()) {
      finish();
    }
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  [[nodiscard]] std::FILE* stream() const { return stream_; }
  // How much was shown in all.
  std::size_t finish() {
    std::fclose(stream_);
    reader_.join();
    close(master_);
    return bytes_;
  }

private:
  int master_ = -1;
  std::FILE* stream_ = nullptr;
  std::size_t bytes_ = 0;
  std::jthread reader_; // the last member: it ends before what it uses
};

struct Cost {
  double cpu_s = 0.0;
  std::uint64_t result = 0; // bits
};

// Pieces of about a fifth of a millisecond; a step takes several milliseconds.
Cost work(std::size_t pieces, const SharedWorkCount& count) {
  const double before_s = cpu_s();
  if (count) {
    count->begin("working", "pieces", pieces);
  }
  double sum = 0.0;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    for (int i = 0; i < 10'000; ++i) {
      sum += std::sin(1e-3 * static_cast<double>(i) + sum);
    }
    if (count) {
      count->add_done();
    }
  }
  return {cpu_s() - before_s, std::bit_cast<std::uint64_t>(sum)};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

} // namespace

int main(int argc, char** argv) try {
  std::size_t rounds = 7;
  std::size_t pieces = 2000;
  double max_ratio = 1.1;
  CLI::App app("Measures what showing progress costs.");
  app.add_option("--rounds", rounds, "in turns with progress and without")
      ->check(CLI::Range(1, 1000));
  app.add_option("--pieces", pieces, "of work in a round")->check(CLI::Range(100, 1'000'000));
  app.add_option("--max-ratio", max_ratio, "of processor times, with progress to without");
  CLI11_PARSE(app, argc, argv);

  std::vector<double> alone_s;
  std::vector<double> shown_s;
  bool same = true;
  Terminal terminal;
  for (std::size_t round = 0; round < rounds; ++round) {
    const Cost alone = work(pieces, nullptr);
    const WorkProgress progress("working", terminal.stream(), std::chrono::milliseconds(0));
    const Cost shown = work(pieces, progress.count());
    alone_s.push_back(alone.cpu_s);
    shown_s.push_back(shown.cpu_s);
    same = same && alone.result == shown.result;
  }
  const std::size_t bytes = terminal.finish();
  const double ratio = median(shown_s) / median(alone_s);
  fmt::print("{:.4f} s alone, {:.4f} s with progress: ratio {:.4f}; {} bytes shown\n",
             median(alone_s), median(shown_s), ratio, bytes);
  return same && bytes > 0 && ratio <= max_ratio ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "progress_cost: %s\n", problem.what());
  return 1;
}
