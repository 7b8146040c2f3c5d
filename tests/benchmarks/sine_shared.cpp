// The fits behind a C interface, for sine_against_python.py. Time spent here is inside of what that script measures.
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/sine_fit.hpp"

namespace {

using namespace dyncal::analysis;

std::vector<std::span<const double>> channels_of(const double* values, std::int64_t samples, std::int64_t count) {
  std::vector<std::span<const double>> channels;
  for (std::int64_t j = 0; j < count; ++j) channels.emplace_back(values + j * samples, static_cast<std::size_t>(samples));
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

// `values` channel by channel; `out` gets sine, cosine, offset, rss of every channel. 0: success.
int dyncal_fit(double frequency_hz, std::int64_t reference_ns, const std::int64_t* stamps, const double* values, std::int64_t samples,
               std::int64_t count, double* out) {
  const auto channels = channels_of(values, samples, count);
  const auto fits = fit_sine(Frequency::from_hz(frequency_hz), reference_ns, {stamps, static_cast<std::size_t>(samples)}, channels);
  if (!fits) return 1;
  for (std::size_t j = 0; j < fits->size(); ++j) put((*fits)[j], out + 4 * j);
  return 0;
}

// Likewise, after the refined frequency in hertz.
int dyncal_fit_frequency(double start_hz, double search_rel, std::int64_t reference_ns, const std::int64_t* stamps, const double* values,
                         std::int64_t samples, std::int64_t count, double* out) {
  const auto channels = channels_of(values, samples, count);
  const auto fit =
      fit_sine_and_frequency(Frequency::from_hz(start_hz), search_rel, reference_ns, {stamps, static_cast<std::size_t>(samples)}, channels);
  if (!fit) return 1;
  out[0] = fit->frequency.hz();
  for (std::size_t j = 0; j < fit->channels.size(); ++j) put(fit->channels[j], out + 1 + 4 * j);
  return 0;
}
}
