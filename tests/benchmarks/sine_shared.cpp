// The fits behind a C interface, for sine_against_python.py. Time spent here is inside of what that
// script measures.
#include <cstdint>
#include <span>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "analysis/sine/sine_fit.hpp"
#include "tests/benchmarks/only_reading.hpp"

namespace {

using namespace dyncal::analysis;
using dyncal::benchmarks::sum_of;

std::vector<std::span<const double>> channels_of(const double* values, std::int64_t samples,
                                                 std::int64_t count) {
  std::vector<std::span<const double>> channels;
  for (std::int64_t j = 0; j < count; ++j) {
    channels.emplace_back(values + j * samples, static_cast<std::size_t>(samples));
  }
  return channels;
}

void put(const SineFit& fit, double* out) {
  out[0] = fit.sine;
  out[1] = fit.cosine;
  out[2] = fit.offset;
  out[3] = fit.rss;
}

} // namespace

extern "C" {

// All that a fit must read, added up.
#if defined(__x86_64__)
__attribute__((target_clones("avx512f", "avx2", "default")))
#endif
double
dyncal_read(const std::int64_t* stamps, const double* values, std::int64_t samples,
            std::int64_t count) {
  double total = static_cast<double>(sum_of(stamps, static_cast<std::size_t>(samples)));
  for (std::int64_t j = 0; j < count; ++j) {
    total += sum_of(values + j * samples, static_cast<std::size_t>(samples));
  }
  return total;
}

// Puts memory out of all caches.
void dyncal_flush(const void* data, std::int64_t bytes) {
#if defined(__x86_64__)
  for (std::int64_t i = 0; i < bytes; i += 64) {
    _mm_clflush(static_cast<const char*>(data) + i);
  }
  _mm_mfence();
#else
  (void)data;
  (void)bytes;
#endif
}

// `values` channel by channel; `out` gets sine, cosine, offset, rss of every channel. 0: success.
int dyncal_fit(double frequency_hz, std::int64_t reference_ns, const std::int64_t* stamps,
               const double* values, std::int64_t samples, std::int64_t count, double* out) {
  const auto channels = channels_of(values, samples, count);
  const auto fits = fit_sine(Frequency::from_hz(frequency_hz), reference_ns,
                             {stamps, static_cast<std::size_t>(samples)}, channels);
  if (!fits) {
    return 1;
  }
  for (std::size_t j = 0; j < fits->size(); ++j) {
    put((*fits)[j], out + 4 * j);
  }
  return 0;
}

// Likewise, after the refined frequency in hertz.
int dyncal_fit_frequency(double start_hz, double search_rel, std::int64_t reference_ns,
                         const std::int64_t* stamps, const double* values, std::int64_t samples,
                         std::int64_t count, double* out) {
  const auto channels = channels_of(values, samples, count);
  const auto fit = fit_sine_and_frequency(Frequency::from_hz(start_hz), search_rel, reference_ns,
                                          {stamps, static_cast<std::size_t>(samples)}, channels);
  if (!fit) {
    return 1;
  }
  out[0] = fit->frequency.hz();
  for (std::size_t j = 0; j < fit->channels.size(); ++j) {
    put(fit->channels[j], out + 1 + 4 * j);
  }
  return 0;
}
}
