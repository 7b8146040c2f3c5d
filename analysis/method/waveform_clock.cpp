#include "analysis/method/waveform_clock.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Dense>

#include "analysis/sine/separated_lines.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double turns_between_lines = 2.0; // in a block, of the two nearest lines
constexpr double part_of_distance = 0.3;    // to the nearest line, that a search may go
constexpr double leaked_turns = 0.2;        // of a line over the record, by its neighbours
constexpr double sure = 20.0;               // u of a frequency
constexpr std::size_t max_blocks = 40;
constexpr std::size_t min_blocks = 3;
constexpr int max_order = 3;
constexpr double worth_an_order = 12.0; // of chi squared: noise alone gains as much once in 2000
constexpr double visible = 4.0;         // u of a component

// P_1(u), P_2(u), P_3(u)
double legendre(std::size_t order, double u) {
  switch (order) {
  case 1:
    return u;
  case 2:
    return 0.5 * (3.0 * u * u - 1.0);
  default:
    return 0.5 * u * (5.0 * u * u - 3.0);
  }
}

double delay_at(const std::vector<double>& legendre_s, double u) {
  double delay = 0.0;
  for (std::size_t i = 0; i < legendre_s.size(); ++i) {
    delay += legendre_s[i] * legendre(i + 1, u);
  }
  return delay;
}

double nearest_lines_hz(std::span<const Frequency> lines) {
  std::vector<double> hz;
  std::ranges::transform(lines, std::back_inserter(hz), &Frequency::hz);
  std::ranges::sort(hz);
  double nearest = hz.front();
  for (std::size_t i = 1; i < hz.size(); ++i) {
    nearest = std::min(nearest, hz[i] - hz[i - 1]);
  }
  return nearest;
}

// By one line after the other, from low to high frequencies, the other lines being noise: each
// narrows the search for the next, which must not come near the lines beside it.
Expected<double> coarse_rate(std::span<const Frequency> lines, double search_rel,
                             std::int64_t middle_ns, std::span<const std::int64_t> stamps_ns,
                             std::span<const double> values) {
  const double nearest_hz = nearest_lines_hz(lines);
  const double duration_s = 1e-9 * static_cast<double>(stamps_ns.back() - stamps_ns.front());
  std::vector<Frequency> ascending(lines.begin(), lines.end());
  std::ranges::sort(ascending, {}, &Frequency::hz);
  double rate = 0.0;
  double range = search_rel;
  bool is_seen = false;
  Error problem{ErrorCode::no_excitation, "no line of the multi-sine stands out of the noise"};
  for (const Frequency& line : ascending) {
    if (!(range > 0.0) || range * line.hz() > part_of_distance * nearest_hz) {
      continue;
    }
    const auto fit = fit_sine_and_frequency(line.shifted_by_hz(rate * line.hz()), range, middle_ns,
                                            stamps_ns, std::span(&values, 1));
    if (!fit) {
      if (fit.error().code != ErrorCode::no_excitation) {
        problem = fit.error();
      }
      continue;
    }
    is_seen = true;
    rate = fit->frequency.hz() / line.hz() - 1.0;
    const double leaked = leaked_turns / (line.hz() * duration_s);
    range = std::min(range, std::max(leaked, sure * fit->u_frequency_hz / line.hz()));
  }
  if (!is_seen && search_rel > 0.0) {
    return fail(problem);
  }
  return rate;
}

struct Block {
  double u = 0.0; // its middle, -1 to 1 over the record
  std::vector<LinePhasor> lines;
  double delay_s = 0.0;
  double weight = 0.0; // 1 / variance of the delay
};

// Where all of its lines can be told apart; a block with a long gap cannot.
Expected<std::vector<Block>> fit_blocks(std::span<const Frequency> lines,
                                        const WaveformClock& clock,
                                        std::span<const std::int64_t> stamps_ns,
                                        std::span<const double> values) {
  const double wanted = 2.0 * clock.half_s * nearest_lines_hz(lines) / turns_between_lines;
  const auto count = static_cast<std::size_t>(std::clamp(
      std::floor(wanted), static_cast<double>(min_blocks), static_cast<double>(max_blocks)));
  std::vector<Block> blocks;
  std::optional<Error> problem;
  for (std::size_t b = 0; b < count; ++b) {
    const auto edge = [&](std::size_t i) {
      const double u = 2.0 * static_cast<double>(i) / static_cast<double>(count) - 1.0;
      return std::ranges::lower_bound(stamps_ns,
                                      clock.middle_ns + std::llround(1e9 * clock.half_s * u)) -
             stamps_ns.begin();
    };
    const auto first = static_cast<std::size_t>(edge(b));
    const auto behind = b + 1 == count ? stamps_ns.size() : static_cast<std::size_t>(edge(b + 1));
    if (behind <= first) {
      continue;
    }
    const auto of_block = values.subspan(first, behind - first);
    auto fitted = SeparatedLines::make(lines, stamps_ns.subspan(first, behind - first),
                                       std::span(&of_block, 1), LinesMayOverlap::somewhat);
    if (!fitted) {
      problem = std::move(fitted.error());
      continue;
    }
    Block& block = blocks.emplace_back();
    const std::int64_t distance_ns = clock.middle_ns - fitted->origin_ns();
    block.u = -1e-9 * static_cast<double>(distance_ns) / clock.half_s;
    for (std::size_t line = 0; line < lines.size(); ++line) {
      LinePhasor one = fitted->at(line, 0);
      one.phasor *= std::polar(1.0, two_pi * lines[line].reduced_turns(distance_ns));
      block.lines.push_back(one);
    }
  }
  if (blocks.size() < min_blocks) {
    return fail(problem.value_or(
        Error{ErrorCode::too_few_samples, "the record is too short for its lines"}));
  }
  return blocks;
}

// Their delays against the mean phase of each line.
void find_delays(std::span<const Frequency> lines, std::vector<Block>& blocks) {
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<std::complex<double>> mean(lines.size());
    for (std::size_t line = 0; line < lines.size(); ++line) {
      for (const Block& block : blocks) {
        mean[line] +=
            block.lines[line].phasor * std::polar(1.0, -lines[line].angular() * block.delay_s);
      }
    }
    for (Block& block : blocks) {
      double sum = 0.0;
      block.weight = 0.0;
      for (std::size_t line = 0; line < lines.size(); ++line) {
        const LinePhasor& one = block.lines[line];
        const double snr = std::abs(one.phasor) / one.u_component;
        if (!(snr > visible)) {
          continue;
        }
        const double w = lines[line].angular();
        const double expected = w * block.delay_s;
        const double deviation =
            std::arg(one.phasor * std::conj(mean[line]) * std::polar(1.0, -expected)) + expected;
        sum += w * snr * snr * deviation;
        block.weight += w * w * snr * snr;
      }
      block.delay_s = block.weight > 0.0 ? sum / block.weight : 0.0;
    }
  }
}

struct Polynomial {
  std::vector<double> legendre_s;
  double chi_squared = 0.0;
};

Polynomial fit_polynomial(const std::vector<Block>& blocks, std::size_t order) {
  const auto rows = static_cast<Eigen::Index>(blocks.size());
  Eigen::MatrixXd design(rows, static_cast<Eigen::Index>(order) + 1);
  Eigen::VectorXd right(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Block& block = blocks[static_cast<std::size_t>(row)];
    const double root = std::sqrt(block.weight);
    design(row, 0) = root;
    for (std::size_t k = 1; k <= order; ++k) {
      design(row, static_cast<Eigen::Index>(k)) = root * legendre(k, block.u);
    }
    right[row] = root * block.delay_s;
  }
  const Eigen::VectorXd found = design.colPivHouseholderQr().solve(right);
  Polynomial polynomial;
  polynomial.legendre_s.assign(found.data() + 1, found.data() + found.size());
  polynomial.chi_squared = (right - design * found).squaredNorm();
  return polynomial;
}

// Of the lowest order beyond which nothing more is gained.
Polynomial describe_delays(const std::vector<Block>& blocks) {
  Polynomial best = fit_polynomial(blocks, 1);
  for (std::size_t order = 2; order <= max_order && order + 2 < blocks.size(); ++order) {
    Polynomial more = fit_polynomial(blocks, order);
    const double left = more.chi_squared / static_cast<double>(blocks.size() - order - 1);
    if (best.chi_squared - more.chi_squared > worth_an_order * std::max(1.0, left)) {
      best = std::move(more);
    }
  }
  return best;
}

} // namespace

double WaveformClock::rate_rel() const {
  return delay_at(legendre_s, 1.0) / half_s -
         (legendre_s.size() > 1 ? legendre_s[1] / half_s : 0.0);
}

// Legendre's first polynomial has a mean square of a third.
double WaveformClock::u_rate_rel() const {
  return scatter_s * std::sqrt(3.0 / static_cast<double>(blocks)) / half_s;
}

std::vector<std::int64_t>
WaveformClock::in_waveform_time(std::span<const std::int64_t> stamps_ns) const {
  std::vector<std::int64_t> times(stamps_ns.begin(), stamps_ns.end());
  for (std::int64_t& stamp : times) {
    const double u = 1e-9 * static_cast<double>(stamp - middle_ns) / half_s;
    stamp += std::llround(1e9 * delay_at(legendre_s, u));
  }
  return times;
}

Expected<WaveformClock> find_waveform_clock(std::span<const Frequency> lines, double search_rel,
                                            std::span<const std::int64_t> stamps_ns,
                                            std::span<const double> values) {
  if (stamps_ns.size() < 2) {
    return fail(ErrorCode::too_few_samples, "there are no samples in the window");
  }
  WaveformClock clock;
  clock.half_s = 0.5e-9 * static_cast<double>(stamps_ns.back() - stamps_ns.front());
  clock.middle_ns = stamps_ns.front() + (stamps_ns.back() - stamps_ns.front()) / 2;
  DYNCAL_TRY(const auto rate, coarse_rate(lines, search_rel, clock.middle_ns, stamps_ns, values));
  clock.legendre_s = {rate * clock.half_s};
  const std::vector<std::int64_t> coarse = clock.in_waveform_time(stamps_ns);
  DYNCAL_TRY(auto blocks, fit_blocks(lines, clock, coarse, values));
  find_delays(lines, blocks);
  const Polynomial polynomial = describe_delays(blocks);
  clock.legendre_s = polynomial.legendre_s;
  clock.legendre_s.front() += rate * clock.half_s;
  double weights = 0.0;
  for (const Block& block : blocks) {
    weights += block.weight;
  }
  const double free = static_cast<double>(blocks.size() - polynomial.legendre_s.size() - 1);
  clock.blocks = blocks.size();
  clock.scatter_s = std::sqrt(polynomial.chi_squared / std::max(1.0, free) *
                              static_cast<double>(blocks.size()) / weights);
  return clock;
}

} // namespace dyncal::analysis
