#include "analysis/sine/kernel/sine_grid.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "analysis/sine/kernel/sine_kernel.hpp"

namespace dyncal::analysis::kernel {
namespace {

constexpr std::size_t min_record = 2 * grid_samples;
constexpr std::size_t middle = grid_samples / 2;
constexpr std::int64_t intervals = grid_samples - 1;
constexpr double third_order_rad = 3.3e-4; // x^4 / 24 = 5e-16
constexpr double fifth_order_rad = 8.4e-3; // x^6 / 720 = 5e-16

// Of several stretches as long as a block, the median: gaps and steps of the clock do not matter.
// Zero: no such thing.
std::int64_t usual_span_ns(std::span<const std::int64_t> stamps) {
  constexpr std::size_t places = 7;
  std::array<std::int64_t, places> spans{};
  for (std::size_t i = 0; i < places; ++i) {
    const std::size_t first = (stamps.size() - grid_samples) * i / (places - 1);
    if (__builtin_sub_overflow(stamps[first + grid_samples - 1], stamps[first], &spans[i])) {
      return 0;
    }
  }
  std::nth_element(spans.begin(), spans.begin() + places / 2, spans.end());
  return spans[places / 2];
}

} // namespace

std::optional<SampleGrid> sample_grid(std::span<const std::int64_t> stamps,
                                      const Frequency& frequency) {
  constexpr std::int64_t max_span_ns = std::int64_t{1} << 50;
  if (stamps.size() < min_record) {
    return std::nullopt;
  }
  const std::int64_t span_ns = usual_span_ns(stamps);
  const std::int64_t interval_ns = span_ns / intervals;
  if (interval_ns < 3 || span_ns > max_span_ns) {
    return std::nullopt;
  }

  std::optional<SampleGrid> made(std::in_place);
  SampleGrid& grid = *made;
  // k span / intervals, rounded, without overflow.
  const std::int64_t rest_ns = span_ns % intervals;
  for (std::size_t k = 0; k < grid_samples; ++k) {
    const std::int64_t steps = static_cast<std::int64_t>(k) - static_cast<std::int64_t>(middle);
    grid.offsets_ns[k] =
        steps * interval_ns +
        (steps * rest_ns + (steps < 0 ? -intervals / 2 : intervals / 2)) / intervals;
  }
  const TimeAxis axis{frequency.turns_per_ns_high(), frequency.turns_per_ns_low(), 0, 0.0};
  BlockBasis basis;
  DesignSums unused;
  best_kernel().design(grid.offsets_ns, grid_samples, axis, basis, unused);
  std::copy_n(basis.sine, grid_samples, grid.sine);
  std::copy_n(basis.cosine, grid_samples, grid.cosine);
  const double radians_per_ns = frequency.angular() * 1e-9;
  grid.scaled_radians_per_ns = radians_per_ns / std::numbers::sqrt2;
  const std::int64_t half_interval_ns =
      interval_ns / 2 - 1; // so that stamps within the limit increase
  grid.max_ns = std::min(fifth_order_rad / radians_per_ns, static_cast<double>(half_interval_ns));
  grid.max_of_third_order_ns = std::min(third_order_rad / radians_per_ns, grid.max_ns);
  return made;
}

} // namespace dyncal::analysis::kernel
