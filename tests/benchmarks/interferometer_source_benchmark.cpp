// How long the source of an interferometer takes for a raw sample of three channels (u1, u2, sync)
// on its way to the decimated displacement and sync, beside the time that only reading these bytes
// takes.
//
// Numbers are CPU time. The argument is the device's rate in S/s, of which 100 kS/s are left: at
// 500 kS/s a core has 2000 ns for a sample, at 10 MS/s 100 ns; the goal is 20.
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "drivers/interferometer/interferometer_source.hpp"
#include "tests/benchmarks/only_reading.hpp"

namespace {

using namespace dyncal::drivers;
using dyncal::drivers::interferometer::InterferometerSettings;
using dyncal::drivers::interferometer::InterferometerSource;

constexpr double block_s = 0.02;
constexpr std::size_t blocks = 50;

// 100 Hz, so that blocks join, 60 m/s^2.
SampleBlock block_of(double rate_hz) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 1e-3);
  SampleBlock block;
  block.samples = static_cast<std::size_t>(block_s * rate_hz);
  block.clock = RegularClock{0, 1'000'000'000, static_cast<std::int64_t>(rate_hz)};
  block.values.resize(3 * block.samples);
  for (std::size_t i = 0; i < block.samples; ++i) {
    const double angle = 2.0 * std::numbers::pi * 100.0 / rate_hz * static_cast<double>(i);
    const double phi = 500.0 * std::sin(angle) + 0.3;
    block.values[i] = 0.02 + 0.64 * std::cos(phi) + noise(random);
    block.values[block.samples + i] = -0.02 + 0.61 * std::sin(phi - 0.09) + noise(random);
    block.values[2 * block.samples + i] = std::sin(angle);
  }
  return block;
}

SourceDescription description_of(double rate_hz) {
  SourceDescription description;
  for (const char* name : {"u1", "u2", "sync"}) {
    description.channels.push_back({.name = name,
                                    .quantity = "",
                                    .unit = R"(\volt)",
                                    .minimum = -1.0,
                                    .maximum = 1.0,
                                    .resolution = 1.0 / 8192.0});
  }
  description.nominal_rate_hz = rate_hz;
  return description;
}

// Gives the same block again and again.
class Device : public SampleSource {
public:
  explicit Device(double rate_hz) : rate_hz_(rate_hz), block_(block_of(rate_hz)) {}

  Expected<SourceDescription> describe() override { return description_of(rate_hz_); }
  Expected<void> run(SampleSink& sink) override {
    sink.begin_session();
    sink.describe(description_of(rate_hz_));
    for (std::size_t i = 0; i < blocks; ++i) {
      SampleBlock block = block_;
      block.first_sample = i * block.samples;
      sink.take(std::move(block));
    }
    return {};
  }
  void stop() override {}

private:
  double rate_hz_;
  SampleBlock block_;
};

class Sink : public SampleSink {
public:
  void describe(const SourceDescription& /*description*/) override {}
  void begin_session() override {}
  void take(SampleBlock block) override { samples += block.samples; }
  void count(const SampleCounts& /*counts*/) override {}
  void warn(const std::string& /*sentence*/) override {}

  std::size_t samples = 0;
};

void count_samples(benchmark::State& state, std::size_t samples) {
  state.counters["ns/sample"] =
      benchmark::Counter(static_cast<double>(state.iterations() * samples) * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void read(benchmark::State& state) {
  const SampleBlock block = block_of(static_cast<double>(state.range(0)));
  for (auto unused : state) {
    (void)unused;
    for (std::size_t i = 0; i < blocks; ++i) {
      const SampleBlock copy = block; // as the device hands it over
      benchmark::DoNotOptimize(dyncal::benchmarks::sum_of(copy.values.data(), copy.values.size()));
    }
  }
  count_samples(state, blocks * block.samples);
}

void demodulate(benchmark::State& state) {
  const auto rate_hz = static_cast<double>(state.range(0));
  InterferometerSettings settings;
  settings.u1 = "u1";
  settings.u2 = "u2";
  settings.displacement_per_turn_m = 316.4e-9;
  for (auto unused : state) {
    (void)unused;
    state.PauseTiming();
    InterferometerSource source(settings, std::make_unique<Device>(rate_hz));
    Sink sink;
    const bool described = source.describe().has_value();
    state.ResumeTiming();
    if (!described || !source.run(sink)) {
      state.SkipWithError("the source does not run");
      return;
    }
    benchmark::DoNotOptimize(sink.samples);
  }
  count_samples(state, blocks * static_cast<std::size_t>(block_s * rate_hz));
}

BENCHMARK(read)->Arg(500'000)->Arg(10'000'000);
BENCHMARK(demodulate)->Arg(500'000)->Arg(10'000'000);

} // namespace

BENCHMARK_MAIN();
