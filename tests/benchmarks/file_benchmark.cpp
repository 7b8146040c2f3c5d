// How fast recorded series of stamps and four columns become blocks of samples, as sources play
// them: CSV with 17 digits, and NumPy. The files lie in the page cache. Bytes per second are those
// of the file, by the wall clock; CPU is that of all threads.
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <unistd.h>

#include <benchmark/benchmark.h>

#include "drivers/files/file_source.hpp"

namespace {

using namespace dyncal::drivers;

constexpr std::size_t rows = 1'000'000;

std::int64_t stamp(std::size_t row) {
  return 1'700'000'000'123'456'789 + static_cast<std::int64_t>(row * 996'960 + row * row % 61);
}

std::string csv() {
  std::string text = "t_ns,a,b,c,d\n";
  std::mt19937_64 random(1);
  std::normal_distribution<double> value;
  for (std::size_t i = 0; i < rows; ++i) {
    text += std::to_string(stamp(i));
    for (int column = 0; column < 4; ++column) {
      char number[32];
      const auto end = std::to_chars(number, number + sizeof number, value(random)).ptr;
      text += ',';
      text.append(number, end);
    }
    text += '\n';
  }
  return text;
}

std::string npy() {
  std::string header = "{'descr': [('t_ns', '<i8'), ('a', '<f8'), ('b', '<f8'), ('c', '<f8'), "
                       "('d', '<f8')], 'fortran_order': False, "
                       "'shape': (" +
                       std::to_string(rows) + ",), }\n";
  std::string text = "\x93NUMPY" + std::string("\x01\x00", 2);
  text += static_cast<char>(header.size() % 256);
  text += static_cast<char>(header.size() / 256);
  text += header;
  std::mt19937_64 random(1);
  std::normal_distribution<double> value;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::int64_t t_ns = stamp(i);
    const double values[4] = {value(random), value(random), value(random), value(random)};
    text.append(reinterpret_cast<const char*>(&t_ns), sizeof t_ns);
    text.append(reinterpret_cast<const char*>(values), sizeof values);
  }
  return text;
}

class Counter : public SampleSink {
public:
  void describe(const SourceDescription&) override {}
  void begin_session() override {}
  void count(const SampleCounts&) override {}
  void warn(const std::string&) override {}
  void take(SampleBlock block) override {
    benchmark::DoNotOptimize(block.values.data());
    samples += block.samples;
  }
  std::size_t samples = 0;
};

void play(benchmark::State& state, const char* extension, std::string (*make)()) {
  files::FileSettings settings;
  settings.path = std::filesystem::temp_directory_path() /
                  ("dyncal_file_benchmark_" + std::to_string(::getpid()) + extension);
  const std::string text = make();
  std::ofstream(settings.path, std::ios::binary) << text;
  for (auto unused : state) {
    (void)unused;
    files::FileSource source(settings);
    Counter counter;
    if (!source.describe() || !source.run(counter) || counter.samples != rows) {
      std::abort();
    }
  }
  std::filesystem::remove(settings.path);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK_CAPTURE(play, csv, ".csv", csv)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(play, npy, ".npy", npy)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
