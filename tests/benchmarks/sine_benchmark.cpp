// How long sine approximation takes, beside the time that only reading the samples takes.
//
// Arguments are samples and channels. "cold" puts the data out of the caches before every fit, as
// samples that come from a network or a file are; without it the data of 1e5 samples stay in the
// last-level cache and the arithmetic is what is seen. Numbers are CPU time; per sample means all
// channels of one instant.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "tests/benchmarks/only_reading.hpp"

namespace {

using namespace dyncal::analysis;
using dyncal::benchmarks::sum_of;

struct Data {
  std::vector<std::int64_t> stamps;
  std::vector<std::vector<double>> values;
  std::vector<std::span<const double>> channels;

  Data(std::size_t samples, std::size_t count, double noise_sd = 1e-3) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> noise(0.0, noise_sd);
    std::uniform_int_distribution<std::int64_t> jitter(-60, 60);
    const Frequency frequency = *Frequency::parse("80.02");
    for (std::size_t i = 0; i < samples; ++i) {
      stamps.push_back(1'700'000'000'123'456'789 + static_cast<std::int64_t>(i) * 996'960 +
                       jitter(random));
    }
    for (std::size_t j = 0; j < count; ++j) {
      values.emplace_back();
      for (const std::int64_t stamp : stamps) {
        const double turns = frequency.reduced_turns(stamp - stamps.front());
        values.back().push_back(std::sin(2.0 * std::numbers::pi * turns + static_cast<double>(j)) +
                                0.1 + noise(random));
      }
    }
    channels.assign(values.begin(), values.end());
  }

  // Out of every cache.
  void flush() const {
#if defined(__x86_64__)
    const auto flush_range = [](const void* data, std::size_t bytes) {
      for (std::size_t i = 0; i < bytes; i += 64) {
        _mm_clflush(static_cast<const char*>(data) + i);
      }
    };
    flush_range(stamps.data(), stamps.size() * sizeof(std::int64_t));
    for (const auto& one : values) {
      flush_range(one.data(), one.size() * sizeof(double));
    }
    _mm_mfence();
#endif
  }
};

#if defined(__x86_64__)
__attribute__((target_clones("avx512f", "avx2", "default")))
#endif
double
read_only(const Data& data) {
  double total = static_cast<double>(sum_of(data.stamps.data(), data.stamps.size()));
  for (const auto& one : data.values) {
    total += sum_of(one.data(), one.size());
  }
  return total;
}

template <class Work>
void run(benchmark::State& state, bool cold, Work work) {
  const Data data(static_cast<std::size_t>(state.range(0)),
                  static_cast<std::size_t>(state.range(1)));
  for (auto unused : state) {
    (void)unused;
    if (cold) {
      state.PauseTiming();
      data.flush();
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(work(data));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetBytesProcessed(state.iterations() * state.range(0) * (state.range(1) + 1) * 8);
  state.counters["ns/sample"] =
      benchmark::Counter(static_cast<double>(state.iterations() * state.range(0)) * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void read_floor(benchmark::State& state, bool cold) {
  run(state, cold, read_only);
}

void three_parameters(benchmark::State& state, bool cold) {
  const Frequency frequency = *Frequency::parse("80.02");
  run(state, cold, [&](const Data& data) {
    return fit_sine(frequency, data.stamps.front(), data.stamps, data.channels);
  });
}

void four_parameters(benchmark::State& state, bool cold) {
  const Frequency start = *Frequency::parse("80"); // 250 ppm off
  run(state, cold, [&](const Data& data) {
    return fit_sine_and_frequency(start, 1e-3, data.stamps.front(), data.stamps, data.channels);
  });
}

void sizes(benchmark::internal::Benchmark* one) {
  for (const std::int64_t channels : {1, 4}) {
    for (const std::int64_t samples : {1000, 10'000, 100'000, 1'000'000}) {
      one->Args({samples, channels});
    }
  }
}

BENCHMARK_CAPTURE(read_floor, warm, false)->Apply(sizes);
BENCHMARK_CAPTURE(three_parameters, warm, false)->Apply(sizes);
BENCHMARK_CAPTURE(four_parameters, warm, false)->Apply(sizes);
BENCHMARK_CAPTURE(read_floor, cold, true)->Args({100'000, 1})->Args({100'000, 4})->Iterations(200);
BENCHMARK_CAPTURE(three_parameters, cold, true)
    ->Args({100'000, 1})
    ->Args({100'000, 4})
    ->Iterations(200);
BENCHMARK_CAPTURE(four_parameters, cold, true)
    ->Args({100'000, 1})
    ->Args({100'000, 4})
    ->Iterations(200);

// Every kernel that this processor runs, on one block in the first-level cache.
void kernel_block(benchmark::State& state, const kernel::SineKernel* kernel) {
  const Data data(kernel::block_samples, 4);
  const Frequency f = *Frequency::parse("80.02");
  const kernel::TimeAxis axis{f.turns_per_ns_high(), f.turns_per_ns_low(), data.stamps.front(),
                              1e-9};
  const double* values[4] = {data.values[0].data(), data.values[1].data(), data.values[2].data(),
                             data.values[3].data()};
  const kernel::Parameters start[4] = {};
  kernel::DesignSums design;
  kernel::ResidualSums residuals[4];
  const auto channels = static_cast<std::size_t>(state.range(0));
  for (auto unused : state) {
    (void)unused;
    kernel->fit_block(data.stamps.data(), kernel::block_samples, axis, values, channels, start,
                      design, residuals);
    benchmark::DoNotOptimize(residuals);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kernel::block_samples));
}

const bool kernels_registered = [] {
  for (const kernel::SineKernel* const* kernel = kernel::supported_kernels(); *kernel; ++kernel) {
    benchmark::RegisterBenchmark((std::string("kernel_block/") + (*kernel)->name).c_str(),
                                 kernel_block, *kernel)
        ->Arg(1)
        ->Arg(4);
  }
  return true;
}();

} // namespace

BENCHMARK_MAIN();
