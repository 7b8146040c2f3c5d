#include "analysis/clock/sync_clock_monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t blocks_on_each_side = 4;

struct Level { // mean of some blocks
  double mean_s = 0.0;
  double u_s = 0.0;
  std::size_t blocks = 0;
};

Level level_of(std::span<const ClockComparison> blocks) {
  Level level;
  level.blocks = blocks.size();
  const double n = static_cast<double>(blocks.size());
  double variance = 0.0;
  for (const ClockComparison& block : blocks) {
    level.mean_s += block.error_s / n;
    variance += block.u_error_s * block.u_error_s;
  }
  level.u_s = std::sqrt(variance) / n;
  return level;
}

} // namespace

Expected<std::vector<ClockComparison>>
compare_clock_with_sync(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                        std::span<const double> sync, int periods) {
  if (stamps_ns.size() != sync.size() || periods < 1) {
    return fail(ErrorCode::invalid_argument,
                "a clock comparison needs as many stamps as values, and at least one period");
  }
  if (stamps_ns.empty()) {
    return fail(ErrorCode::too_few_samples, "there are no samples to compare the clock by");
  }
  const std::array whole_record{sync};
  const auto whole = fit_sine(frequency, stamps_ns.front(), stamps_ns, whole_record);
  if (!whole) {
    return fail(whole.error());
  }
  const std::complex<double> mean((*whole)[0].sine, (*whole)[0].cosine);

  const double block_ns = static_cast<double>(periods) * 1e9 / frequency.hz();
  const auto count = static_cast<std::int64_t>(
      static_cast<double>(stamps_ns.back() - stamps_ns.front()) / block_ns);
  if (count < 3) {
    return fail(ErrorCode::too_few_samples, "a clock comparison needs at least three blocks");
  }
  std::vector<ClockComparison> result;
  auto first = stamps_ns.begin();
  for (std::int64_t k = 0; k < count; ++k) {
    ClockComparison block;
    block.begin_ns = stamps_ns.front() + std::llround(static_cast<double>(k) * block_ns);
    block.end_ns = stamps_ns.front() + std::llround(static_cast<double>(k + 1) * block_ns);
    const auto last = std::lower_bound(first, stamps_ns.end(), block.end_ns);
    const auto begin = static_cast<std::size_t>(first - stamps_ns.begin());
    const auto size = static_cast<std::size_t>(last - first);
    first = last;
    const std::array channels{sync.subspan(begin, size)};
    const auto fit =
        fit_sine(frequency, stamps_ns.front(), stamps_ns.subspan(begin, size), channels);
    if (!fit) {
      continue; // lost samples: a thin block has no phase to use
    }
    const std::complex<double> phasor((*fit)[0].sine, (*fit)[0].cosine);
    block.error_s = std::arg(phasor * std::conj(mean)) / frequency.angular();
    block.u_error_s = (*fit)[0].u_phase_rad() / frequency.angular();
    result.push_back(block);
  }
  if (result.size() < 3) {
    return fail(ErrorCode::too_few_samples, "too many samples are missing to compare the clock");
  }
  return result;
}

EventOrigin origin_of_event(std::span<const ClockComparison> comparisons, std::int64_t event_ns,
                            double size_s) {
  const auto before_end =
      std::find_if(comparisons.begin(), comparisons.end(),
                   [&](const ClockComparison& block) { return block.end_ns > event_ns; });
  const auto after_begin =
      std::find_if(before_end, comparisons.end(),
                   [&](const ClockComparison& block) { return block.begin_ns > event_ns; });
  const auto before = static_cast<std::size_t>(before_end - comparisons.begin());
  const auto after = static_cast<std::size_t>(after_begin - comparisons.begin());
  const std::size_t kept_before = std::min(before, blocks_on_each_side);
  const std::size_t kept_after = std::min(comparisons.size() - after, blocks_on_each_side);
  if (kept_before == 0 || kept_after == 0) {
    return EventOrigin::undecided;
  }
  const Level low = level_of(comparisons.subspan(before - kept_before, kept_before));
  const Level high = level_of(comparisons.subspan(after, kept_after));
  const double jump = high.mean_s - low.mean_s;
  const double u = std::hypot(low.u_s, high.u_s);
  if (!(std::abs(size_s) > 8.0 * u)) {
    return EventOrigin::undecided;
  }
  if (std::abs(jump + size_s) < 4.0 * u) {
    return EventOrigin::dau_clock;
  }
  if (std::abs(jump) < 4.0 * u) {
    return EventOrigin::sensor;
  }
  return EventOrigin::undecided;
}

} // namespace dyncal::analysis
