// How fast recorded series of stamps and four columns become blocks of samples, as sources play
// them: CSV with 17 digits, and NumPy; of TDMS four channels of doubles one after the other, in
// rows, and of int16 that are scaled. The files lie in the page cache. Bytes per second are those
// of the file, by the wall clock; CPU is that of all threads. `only_read` reads the same bytes, by
// read() in pieces of 64 KiB and a sum over them: what there is to be had.
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <string>
#include <unistd.h>
#include <vector>

#include <benchmark/benchmark.h>

#include "drivers/files/file_source.hpp"
#include "tests/unit/drivers/files/tdms_bytes.hpp"

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

// Four channels of a type, in one segment with values that do not matter.
std::string tdms(std::uint32_t contents, std::uint32_t type, std::size_t bytes_of_value) {
  files::TdmsBytes metadata;
  metadata.add(std::uint32_t{4});
  for (const char* path : {"/'g'/'a'", "/'g'/'b'", "/'g'/'c'", "/'g'/'d'"}) {
    metadata.text(path).index(type, rows).add(std::uint32_t{5}).property("wf_increment", 1e-5);
    metadata.property("NI_Number_Of_Scales", bytes_of_value == 8 ? 0U : 1U);
    metadata.property("NI_Scale[0]_Scale_Type", "Linear");
    metadata.property("NI_Scale[0]_Linear_Slope", 3e-4);
    metadata.property("NI_Scale[0]_Linear_Y_Intercept", 0.5);
  }
  std::string data(4 * rows * bytes_of_value, '\0');
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < data.size(); i += 3) {
    data[i] = static_cast<char>(random() % 64); // as a double: no NaN, no denormal above it
  }
  return files::tdms_segment(files::tdms_whole | contents, metadata.bytes(), data);
}

std::string tdms_contiguous() {
  return tdms(0, 10, 8);
}

std::string tdms_rows() {
  return tdms(files::tdms_interleaved, 10, 8);
}

std::string tdms_i16() {
  return tdms(0, 2, 2);
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
BENCHMARK_CAPTURE(play, tdms_contiguous, ".tdms", tdms_contiguous)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(play, tdms_rows, ".tdms", tdms_rows)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(play, tdms_i16, ".tdms", tdms_i16)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void only_read(benchmark::State& state) {
  const std::string text = tdms_contiguous();
  const auto path = std::filesystem::temp_directory_path() /
                    ("dyncal_file_benchmark_" + std::to_string(::getpid()) + ".bytes");
  std::ofstream(path, std::ios::binary) << text;
  std::vector<std::uint64_t> piece(std::size_t{1} << 13U);
  for (auto unused : state) {
    (void)unused;
    std::ifstream file(path, std::ios::binary);
    file.rdbuf()->pubsetbuf(nullptr, 0);
    std::uint64_t sum = 0;
    while (file.read(reinterpret_cast<char*>(piece.data()),
                     static_cast<std::streamsize>(piece.size() * sizeof(piece[0]))),
           file.gcount() > 0) {
      sum = std::accumulate(piece.begin(), piece.end(), sum);
    }
    benchmark::DoNotOptimize(sum);
  }
  std::filesystem::remove(path);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(only_read)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
