// How fast `dyncal analyse` evaluates recorded files, beside the time that only looking at every
// byte of them takes (the lines of a CSV file counted in one thread): all in one run, on the same
// files, which lie in the page cache; the quickest of some runs counts.
//   analyse_speed [--program P] [--folder F] [--only KIND] [--step-s 20] [--runs 5] [--disturbed]
// A step lasts 20 s in the full form: 9.5 million samples. With --disturbed harmonics and hum are
// found and taken out as well. Exit status 1 when a run does not give every result.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "drivers/files/mapped_file.hpp"
#include "tests/system/program_run.hpp"

namespace {

using namespace dyncal;
using Clock = std::chrono::steady_clock;

constexpr double acs_rate_hz = 50'000.0;
constexpr double dau_rate_hz = 1'000.0;
constexpr double off_s = 1.0;
constexpr double frequencies_hz[] = {20.0, 80.0, 160.0};
constexpr int repetitions = 3;

struct Options {
  std::string program = DYNCAL;
  std::filesystem::path folder = std::filesystem::temp_directory_path();
  std::string only;
  double step_s = 20.0;
  int runs = 5;
  bool disturbed = false;
};

// One source's samples, made as they are asked for: the excitation, seen by channels that differ in
// size and noise.
class Series {
public:
  Series(const Options& options, double rate_hz, std::size_t channels)
      : options_(options), rate_hz_(rate_hz), channels_(channels), random_(channels) {}

  [[nodiscard]] std::size_t channels() const { return channels_; }
  [[nodiscard]] std::size_t samples() const {
    const double steps = static_cast<double>(std::size(frequencies_hz)) * repetitions;
    return static_cast<std::size_t>(rate_hz_ * (off_s + steps * (options_.step_s + off_s)));
  }
  [[nodiscard]] std::int64_t stamp_ns(std::size_t i) const {
    return 1'700'000'000'000'000'000 + std::llround(static_cast<double>(i) * 1e9 / rate_hz_);
  }

  void sample(std::size_t i, std::vector<double>& values) {
    const double t_s = static_cast<double>(i) / rate_hz_;
    const double in_step_s = std::fmod(t_s, options_.step_s + off_s) - off_s;
    const auto step = static_cast<std::size_t>(t_s / (options_.step_s + off_s));
    const double phase =
        2.0 * std::numbers::pi * frequencies_hz[step % std::size(frequencies_hz)] * t_s;
    const double sine = in_step_s < 0.0 ? 0.0 : std::sin(phase);
    const double hum = options_.disturbed ? 1e-3 * std::sin(2.0 * std::numbers::pi * 50.0 * t_s) +
                                                1e-3 * std::sin(2.0 * phase)
                                          : 0.0;
    for (std::size_t channel = 0; channel < channels_; ++channel) {
      values[channel] =
          (1.0 + static_cast<double>(channel)) * (sine + hum + 1e-3 * noise_(random_));
    }
  }

private:
  const Options& options_;
  double rate_hz_;
  std::size_t channels_;
  std::mt19937_64 random_;
  std::normal_distribution<double> noise_;
};

std::string name_of(std::size_t channel) {
  return "channel_" + std::to_string(channel);
}

void write_csv(const std::filesystem::path& path, Series series) {
  std::string text = "t_ns";
  for (std::size_t channel = 0; channel < series.channels(); ++channel) {
    text += ',' + name_of(channel);
  }
  std::ofstream file(path, std::ios::binary);
  std::vector<double> values(series.channels());
  for (std::size_t i = 0; i < series.samples(); ++i) {
    text += '\n' + std::to_string(series.stamp_ns(i));
    series.sample(i, values);
    for (const double value : values) {
      char number[32];
      text += ',';
      text.append(number, std::to_chars(number, number + sizeof number, value).ptr);
    }
    if (text.size() > (1U << 20U)) {
      file << text;
      text.clear();
    }
  }
  file << text << '\n';
}

void write_npy(const std::filesystem::path& path, Series series) {
  std::string fields = "('t_ns', '<i8')";
  for (std::size_t channel = 0; channel < series.channels(); ++channel) {
    fields += ", ('" + name_of(channel) + "', '<f8')";
  }
  const std::string header = fmt::format(
      "{{'descr': [{}], 'fortran_order': False, 'shape': ({},), }}\n", fields, series.samples());
  std::string text = "\x93NUMPY" + std::string("\x01\x00", 2);
  text += static_cast<char>(header.size() % 256);
  text += static_cast<char>(header.size() / 256);
  text += header;
  std::ofstream file(path, std::ios::binary);
  std::vector<double> values(series.channels());
  for (std::size_t i = 0; i < series.samples(); ++i) {
    const std::int64_t stamp_ns = series.stamp_ns(i);
    series.sample(i, values);
    text.append(reinterpret_cast<const char*>(&stamp_ns), sizeof stamp_ns);
    text.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
    if (text.size() > (1U << 20U)) {
      file << text;
      text.clear();
    }
  }
  file << text;
}

// One bench with its files in a folder of its own, which goes with the object.
class Bench {
public:
  Bench(const Options& options, std::string name, std::size_t channels, const std::string& ending,
        bool with_dau)
      : name_(std::move(name)),
        folder_(options.folder /
                ("dyncal_analyse_speed_" + std::to_string(::getpid()) + "_" + name_)),
        samples_(Series(options, acs_rate_hz, channels).samples()) {
    std::filesystem::create_directories(folder_);
    const auto write = ending == "npy" ? write_npy : write_csv;
    write(folder_ / ("acs." + ending), Series(options, acs_rate_hz, channels));
    files_.push_back(folder_ / ("acs." + ending));
    if (with_dau) {
      write(folder_ / ("dau." + ending), Series(options, dau_rate_hz, 2));
      files_.push_back(folder_ / ("dau." + ending));
    }
    std::ofstream(bench_file()) << text(options, ending, with_dau);
  }
  ~Bench() { std::filesystem::remove_all(folder_); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] std::filesystem::path bench_file() const { return folder_ / "bench.toml"; }
  [[nodiscard]] std::filesystem::path result_file() const { return folder_ / "result.json"; }
  [[nodiscard]] const std::vector<std::filesystem::path>& files() const { return files_; }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] std::uintmax_t bytes() const {
    std::uintmax_t sum = 0;
    for (const auto& file : files_) {
      sum += std::filesystem::file_size(file);
    }
    return sum;
  }

private:
  static std::string text(const Options& options, const std::string& ending, bool with_dau) {
    std::string text = fmt::format(
        "bench = \"speed\"\n[excitation]\nfrequencies_hz = [\"20\", \"80\", \"160\"]\nlevel = 1.0\n"
        "repetitions = {}\nsettling_s = 0.2\nduration_s = {}\n",
        repetitions, options.step_s - 1.0);
    const auto source = [&](const char* name) {
      text += fmt::format("[sources.{0}]\ndriver = \"file\"\npath = \"{0}.{1}\"\nunits = {{ "
                          "channel_0 = \"m/s^2\", channel_1 = \"V\" }}\n",
                          name, ending);
    };
    source("acs");
    if (with_dau) {
      source("dau");
      text += "[method]\nkind = \"sample-timestamping\"\nreference = \"acs/channel_0\"\nsync_acs = "
              "\"acs/channel_1\"\n"
              "sync_dau = \"dau/channel_1\"\ndut = [\"dau/channel_0\"]\n";
    } else {
      text += "[method]\nkind = \"analogue\"\nreference = \"acs/channel_0\"\ndut = "
              "[\"acs/channel_1\"]\n";
    }
    return text;
  }

  std::string name_;
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> files_;
  std::size_t samples_;
};

struct Cost {
  double wall_s = 0.0;
  double cpu_s = 0.0;
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// The time to count the lines of the files.
double reading_s(const Bench& bench, int runs) {
  double quickest = 1e9;
  for (int run = 0; run < runs; ++run) {
    const auto begin = Clock::now();
    std::ptrdiff_t lines = 0;
    for (const auto& path : bench.files()) {
      const auto file = drivers::files::MappedFile::open(path);
      if (!file) {
        throw std::runtime_error(file.error().message);
      }
      lines += std::count(file->text().begin(), file->text().end(), '\n');
    }
    if (lines == 0) {
      throw std::runtime_error(bench.name() + ": an empty file");
    }
    quickest = std::min(quickest, seconds_since(begin));
  }
  return quickest;
}

Cost analysing(const Options& options, const Bench& bench) {
  Cost quickest{1e9, 1e9};
  for (int run = 0; run < options.runs; ++run) {
    tests::ProgramRun process(options.program,
                              {"analyse", bench.bench_file(), "--output", bench.result_file()},
                              bench.folder());
    const auto status = process.wait(std::chrono::seconds(600));
    const double wall_s = process.seconds(); // the check of its result is not its own time
    if (status != 0) {
      throw std::runtime_error(bench.name() + ": " + process.errors());
    }
    quickest = {std::min(quickest.wall_s, wall_s), std::min(quickest.cpu_s, process.cpu_s())};
  }
  return quickest;
}

void measure(const Options& options, const Bench& bench) {
  const double read_s = reading_s(bench, options.runs);
  const Cost cost = analysing(options, bench);
  const double megabytes = static_cast<double>(bench.bytes()) * 1e-6;
  fmt::print("{:12} {:8.1f} {:10.2f} {:10.3f} {:10.3f} {:10.3f} {:8.0f} {:10.1f} {:9.1f}\n",
             bench.name(), megabytes, static_cast<double>(bench.samples()) * 1e-6, read_s,
             cost.wall_s, cost.cpu_s, megabytes / cost.wall_s,
             static_cast<double>(bench.samples()) * 1e-6 / cost.wall_s, cost.wall_s / read_s);
}

} // namespace

int main(int argc, char** argv) try {
  Options options;
  CLI::App app("Measures dyncal analyse on recorded files.");
  app.add_option("--program", options.program, "dyncal");
  app.add_option("--folder", options.folder, "where the files are made; 2.5 GB in the full form");
  app.add_option("--only", options.only, "one kind of files alone")
      ->check(CLI::IsMember({"narrow csv", "wide csv", "npy"}));
  app.add_option("--step-s", options.step_s, "how long a step lasts, in seconds")
      ->check(CLI::Range(2.5, 1000.0));
  app.add_option("--runs", options.runs, "of which the quickest counts")
      ->check(CLI::Range(1, 1000));
  app.add_flag("--disturbed", options.disturbed, "with harmonics and hum");
  CLI11_PARSE(app, argc, argv);
  fmt::print("{:12} {:>8} {:>10} {:>10} {:>10} {:>10} {:>8} {:>10} {:>9}\n", "files", "MB",
             "1e6 rows", "reading/s", "analyse/s", "CPU/s", "MB/s", "1e6 rows/s", "/ reading");
  const auto measure_kind = [&](const char* name, std::size_t channels, const char* ending,
                                bool with_dau) {
    if (options.only.empty() || options.only == name) {
      measure(options, Bench(options, name, channels, ending, with_dau));
    }
  };
  measure_kind("narrow csv", 2, "csv", true);
  measure_kind("wide csv", 12, "csv", false);
  measure_kind("npy", 2, "npy", true);
  return 0;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "analyse_speed: %s\n", problem.what());
  return 1;
}
