#include "analysis/step/settling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "analysis/base/statistics.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr double max_blocks = 64.0;
constexpr double min_blocks = 8.0;
constexpr double scatter_factor = 4.0;

struct Block {
  std::int64_t begin_ns = 0;
  std::complex<double> phasor;
};

Expected<std::vector<Block>> block_phasors(const Frequency& frequency,
                                           std::span<const std::int64_t> stamps_ns,
                                           std::span<const double> values) {
  const double period_ns = 1e9 / frequency.hz();
  const double periods =
      std::floor(static_cast<double>(stamps_ns.back() - stamps_ns.front()) / period_ns);
  const double periods_per_block = std::max(1.0, std::ceil(periods / max_blocks));
  const double count = std::floor(periods / periods_per_block);
  if (count < min_blocks) {
    return fail(ErrorCode::too_few_samples, "settling cannot be seen in fewer than eight periods");
  }
  const double block_ns = periods_per_block * period_ns;
  // Blocks end with the record, so that its end is what counts as settled.
  const double start_ns =
      static_cast<double>(stamps_ns.back() - stamps_ns.front()) - count * block_ns;
  std::vector<Block> blocks;
  auto first = std::lower_bound(stamps_ns.begin(), stamps_ns.end(),
                                stamps_ns.front() + std::llround(start_ns));
  for (double k = 1.0; k <= count; k += 1.0) {
    const auto last =
        k == count ? stamps_ns.end()
                   : std::lower_bound(first, stamps_ns.end(),
                                      stamps_ns.front() + std::llround(start_ns + k * block_ns));
    const auto begin = static_cast<std::size_t>(first - stamps_ns.begin());
    const auto size = static_cast<std::size_t>(last - first);
    const std::array channels{values.subspan(begin, size)};
    DYNCAL_TRY(const auto fit,
               fit_sine(frequency, stamps_ns.front(), stamps_ns.subspan(begin, size), channels));
    blocks.push_back({stamps_ns[begin], {fit[0].sine, fit[0].cosine}});
    first = last;
  }
  return blocks;
}

} // namespace

Expected<Settling> find_settling(const Frequency& frequency,
                                 std::span<const std::int64_t> stamps_ns,
                                 std::span<const double> values, const SettlingSettings& settings) {
  if (stamps_ns.size() != values.size() || stamps_ns.size() < 2) {
    return fail(ErrorCode::invalid_argument,
                "settling needs as many stamps as values, and at least two");
  }
  DYNCAL_TRY(const auto blocks, block_phasors(frequency, stamps_ns, values));

  const std::size_t settled = blocks.size() - blocks.size() / 3;
  std::complex<double> mean;
  for (std::size_t k = settled; k < blocks.size(); ++k) {
    mean += blocks[k].phasor / static_cast<double>(blocks.size() - settled);
  }
  const double size = std::abs(mean);
  if (!(size > 0.0)) {
    return fail(ErrorCode::no_excitation, "there is no sine whose settling could be found");
  }
  std::vector<double> deviations;
  for (std::size_t k = settled; k < blocks.size(); ++k) {
    deviations.push_back(std::abs(blocks[k].phasor - mean));
  }
  // The median of the distance from the centre of a bivariate normal distribution is 1.1774 s.
  const double scatter = upper_median(deviations) / 1.1774;
  const double limit = std::max(scatter_factor * scatter, settings.tolerance_rel * size);

  Settling result;
  result.begin_ns = stamps_ns.front();
  result.steady_scatter_rel = scatter / size;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const double deviation = std::abs(blocks[k].phasor - mean);
    if (deviation <= limit) {
      continue;
    }
    if (k + 1 >= blocks.size() || 2 * k >= blocks.size()) {
      return fail(ErrorCode::not_converged,
                  "the excitation does not settle: less than half of the record is steady");
    }
    result.begin_ns = blocks[k + 1].begin_ns;
    result.max_deviation = std::max(result.max_deviation, deviation / size);
  }
  result.settling_s = static_cast<double>(result.begin_ns - stamps_ns.front()) * 1e-9;
  return result;
}

} // namespace dyncal::analysis
