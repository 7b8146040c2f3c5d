// How long it takes from pairs of int16 to phase and on to decimated displacement, beside the time
// that only reading these bytes takes. At 10 MS/s a core has 100 ns for a pair; the goal is 20.
//
// Numbers are CPU time. The argument is the number of pairs: 65536 stay in a cache, 10^7 do not.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "analysis/interferometer/decimation_filter.hpp"
#include "analysis/interferometer/ellipse_moments.hpp"
#include "analysis/interferometer/kernel/quadrature_kernel.hpp"
#include "analysis/interferometer/quadrature_phase.hpp"
#include "tests/benchmarks/only_reading.hpp"

namespace {

using namespace dyncal::analysis;
using dyncal::benchmarks::sum_of;

const Ellipse ellipse{197.0, -197.0, 1.05, 0.0873, 6553.0};
constexpr std::size_t pairs_at_once = 4096;

struct Pairs {
  std::vector<std::int16_t> u1;
  std::vector<std::int16_t> u2;

  explicit Pairs(std::size_t n) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> noise(0.0, 13.0);
    for (std::size_t i = 0; i < n; ++i) {
      const double t = 2.0 * std::numbers::pi * 80.0 / 10e6 * static_cast<double>(i);
      const double phi = 7860.0 * std::sin(t) + 0.3;
      const auto counts = [&](double value) {
        return static_cast<std::int16_t>(std::lround(value + noise(random)));
      };
      u1.push_back(counts(ellipse.p + ellipse.radius * std::cos(phi)));
      u2.push_back(
          counts(ellipse.q + ellipse.radius / ellipse.r * std::sin(phi - ellipse.alpha_rad)));
    }
  }
};

template <class Work>
void run(benchmark::State& state, Work work) {
  const Pairs pairs(static_cast<std::size_t>(state.range(0)));
  for (auto unused : state) {
    (void)unused;
    benchmark::DoNotOptimize(work(pairs));
  }
  state.counters["ns/pair"] =
      benchmark::Counter(static_cast<double>(state.iterations() * state.range(0)) * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

#if defined(__x86_64__)
__attribute__((target_clones("avx512f", "avx2", "default")))
#endif
int
read_pairs(const Pairs& pairs) {
  return sum_of(pairs.u1.data(), pairs.u1.size()) + sum_of(pairs.u2.data(), pairs.u2.size());
}

double phase_by_library(const Pairs& pairs) {
  const kernel::QuadratureCorrection c = correction_of(ellipse);
  double last = 0.0;
  double whole = 0.0;
  for (std::size_t i = 0; i < pairs.u1.size(); ++i) {
    const double x = pairs.u1[i] - c.p;
    const double turns =
        std::atan2((pairs.u2[i] - c.q) * c.scale + x * c.tangent, x) / (2.0 * std::numbers::pi);
    whole -= std::nearbyint(turns - last);
    last = turns;
  }
  return last + whole;
}

double wrapped_phase(const kernel::QuadratureKernel& variant, const Pairs& pairs) {
  const kernel::QuadratureCorrection c = correction_of(ellipse);
  double turns[pairs_at_once];
  double radius_squared[pairs_at_once];
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.u1.size(); i += pairs_at_once) {
    const std::size_t n = std::min(pairs_at_once, pairs.u1.size() - i);
    variant.phase_of_int16(&pairs.u1[i], &pairs.u2[i], n, c, turns, radius_squared);
    sum += turns[0];
  }
  return sum;
}

// To 80 kS/s, as for steps up to 19 kHz; factor 1 leaves the phase as it is.
double to_decimated_phase(const Pairs& pairs, std::size_t factor) {
  QuadraturePhase phase(ellipse);
  DecimationFilter filter(factor);
  std::vector<double> turns(pairs_at_once);
  std::vector<double> decimated;
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.u1.size(); i += pairs_at_once) {
    const std::size_t n = std::min(pairs_at_once, pairs.u1.size() - i);
    const std::span<double> block = std::span(turns).first(n);
    if (!phase.push(std::span(pairs.u1).subspan(i, n), std::span(pairs.u2).subspan(i, n), block)) {
      return 0.0;
    }
    decimated.clear();
    if (factor > 1) {
      filter.push(block, decimated);
    }
    sum += decimated.empty() ? block[0] : decimated[0];
  }
  return sum;
}

std::uint64_t moments(const Pairs& pairs) {
  EllipseMoments sums;
  sums.add(std::span(pairs.u1), std::span(pairs.u2));
  return sums.samples() + (sums.difference_variance_1() > 0.0 ? 1 : 0);
}

template <class Work>
void add(const std::string& name, Work work) {
  benchmark::RegisterBenchmark(name.c_str(), [work](benchmark::State& state) { run(state, work); })
      ->Arg(65536)
      ->Arg(10'000'000);
}

} // namespace

int main(int argc, char** argv) {
  add("read", read_pairs);
  add("library_atan2_and_unwrap", phase_by_library);
  for (const auto* const* one = kernel::supported_quadrature_kernels(); *one != nullptr; ++one) {
    const kernel::QuadratureKernel& variant = **one;
    add(std::string("wrapped_phase/") + variant.name,
        [&variant](const Pairs& pairs) { return wrapped_phase(variant, pairs); });
  }
  add("unwrapped_phase", [](const Pairs& pairs) { return to_decimated_phase(pairs, 1); });
  add("decimated_phase", [](const Pairs& pairs) { return to_decimated_phase(pairs, 125); });
  add("moments", moments);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
