// What showing progress costs (services/programs/command/work_progress.hpp): the same work, counted
// and shown on a terminal from its beginning, and without, in turns: pieces of work, a CSV file
// that is read, JSON that is parsed, a fit with harmonics. Compared is the processor time, which
// other programs of the machine make longer only; the ratio is that of the shortest.
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
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <thread>
#include <vector>

#include <pty.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "analysis/sine/extended_sine_fit.hpp"
#include "services/base/counted_text.hpp"
#include "services/base/whole_file.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/replay/series_file.hpp"

namespace {

using namespace dyncal;

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

// Gives a number that depends on every bit of what it computes.
using Work = std::function<double(const SharedWorkCount& count)>;

struct Cost {
  double cpu_s = 0.0;
  std::uint64_t result = 0; // bits
};

Cost cost_of(const Work& work, const SharedWorkCount& count) {
  const double before_s = cpu_s();
  const double result = work(count);
  return {cpu_s() - before_s, std::bit_cast<std::uint64_t>(result)};
}

// Pieces of about a fifth of a millisecond; a step takes several milliseconds.
double do_pieces(std::size_t pieces, const SharedWorkCount& count) {
  begin_work(count, "working", "pieces", pieces);
  double sum = 0.0;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    for (int i = 0; i < 10'000; ++i) {
      sum += std::sin(1e-3 * static_cast<double>(i) + sum);
    }
    add_done(count);
  }
  return sum;
}

// Of some 50 and 10 MB, gone at the end.
class Files {
public:
  Files() {
    std::string name = (std::filesystem::temp_directory_path() / "progress_cost_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("no folder for temporary files can be made");
    }
    folder_ = name;
    std::ofstream series(csv());
    series << "t_ns,sensor,reference\n";
    std::ofstream numbers(json());
    numbers << "[0";
    for (int i = 0; i < 2'000'000; ++i) {
      series << i * 1'000'000LL << ',' << 0.001 * (i % 997) << ',' << 0.125 * (i % 13) << '\n';
      if (i % 4 == 0) {
        numbers << fmt::format(",{:.15f}", 0.001 * (i % 997));
      }
    }
    numbers << "]";
  }
  ~Files() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;

  [[nodiscard]] std::filesystem::path csv() const { return folder_ / "series.csv"; }
  [[nodiscard]] std::filesystem::path json() const { return folder_ / "numbers.json"; }

private:
  std::filesystem::path folder_;
};

double read_csv(const Files& files, const SharedWorkCount& count) {
  const auto series = read_series_file(files.csv(), count);
  double sum = 0.0;
  for (const std::vector<double>& column : series.value().columns) {
    for (const double value : column) {
      sum = 0.5 * sum + value;
    }
  }
  return sum;
}

double sum_of(const nlohmann::json& numbers) {
  double sum = 0.0;
  for (const nlohmann::json& number : numbers) {
    sum = 0.5 * sum + number.get<double>();
  }
  return sum;
}

double read_json(const Files& files, const SharedWorkCount& count) {
  const std::uintmax_t size = bytes_of_file(files.json());
  const std::string text = read_whole_file(files.json(), size).value();
  if (!count) {
    return sum_of(nlohmann::json::parse(text));
  }
  ByteCount bytes(count, "reading", size);
  const CountedText counted(text, bytes);
  return sum_of(nlohmann::json::parse(counted.begin(), counted.end()));
}

class Sine {
public:
  Sine() {
    constexpr std::size_t samples = 4'000'000;
    for (std::size_t i = 0; i < samples; ++i) {
      stamps_ns_.push_back(static_cast<std::int64_t>(i) * 100'000);
      values_.push_back(std::sin(2e-2 * std::numbers::pi * static_cast<double>(i)) +
                        1e-3 * static_cast<double>(i % 7));
    }
  }

  [[nodiscard]] double fit(const SharedWorkCount& count) const {
    dyncal::analysis::Progress progress;
    if (count) {
      count->begin_share("fitting");
      progress = [&count](double share) { count->set_share_done(share); };
    }
    const std::array<std::span<const double>, 1> channels{values_};
    const auto fits = dyncal::analysis::fit_sine_extended(
        *dyncal::analysis::Frequency::parse("100"), {.max_harmonic = 3, .lines = {}},
        dyncal::analysis::Weighting::none, 0, stamps_ns_, channels, progress);
    return fits.value().front().fundamental.sine + fits.value().front().fundamental.rss;
  }

private:
  std::vector<std::int64_t> stamps_ns_;
  std::vector<double> values_;
};

struct Ratio {
  double of_processor_time = 0.0;
  bool same_result = true;
};

Ratio compare(const std::string& name, const Work& work, std::size_t rounds, std::FILE* terminal) {
  std::vector<double> alone_s;
  std::vector<double> shown_s;
  const auto shortest = [](const std::vector<double>& times_s) {
    return *std::min_element(times_s.begin(), times_s.end());
  };
  Ratio ratio;
  for (std::size_t round = 0; round < rounds; ++round) {
    const Cost alone = cost_of(work, nullptr);
    const WorkProgress progress("working", terminal, std::chrono::milliseconds(0));
    const Cost shown = cost_of(work, progress.count());
    alone_s.push_back(alone.cpu_s);
    shown_s.push_back(shown.cpu_s);
    ratio.same_result = ratio.same_result && alone.result == shown.result;
  }
  ratio.of_processor_time = shortest(shown_s) / shortest(alone_s);
  fmt::print("{:<8} {:.4f} s alone, {:.4f} s with progress: ratio {:.4f}{}\n", name,
             shortest(alone_s), shortest(shown_s), ratio.of_processor_time,
             ratio.same_result ? "" : ", ANOTHER RESULT");
  return ratio;
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

  const Files files;
  const Sine sine;
  const std::vector<std::pair<std::string, Work>> works{
      {"pieces", [&](const SharedWorkCount& count) { return do_pieces(pieces, count); }},
      {"csv", [&](const SharedWorkCount& count) { return read_csv(files, count); }},
      {"json", [&](const SharedWorkCount& count) { return read_json(files, count); }},
      {"fit", [&](const SharedWorkCount& count) { return sine.fit(count); }}};
  Terminal terminal;
  bool good = true;
  for (const auto& [name, work] : works) {
    const Ratio ratio = compare(name, work, rounds, terminal.stream());
    good = good && ratio.same_result && ratio.of_processor_time <= max_ratio;
  }
  const std::size_t bytes = terminal.finish();
  fmt::print("{} bytes shown\n", bytes);
  return good && bytes > 0 ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "progress_cost: %s\n", problem.what());
  return 1;
}
