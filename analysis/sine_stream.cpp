#include "analysis/sine_stream.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <deque>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "analysis/sine_kernel.hpp"
#include "analysis/sine_series.hpp"
#include "analysis/sine_solve.hpp"

namespace dyncal::analysis {
namespace {

using namespace kernel;
using Complex = std::complex<double>;

constexpr std::size_t block_length = 64;
constexpr std::int64_t gap_intervals = 64; // a block ends before an interval this many times the one before
constexpr std::int64_t longest_span_ns = std::int64_t{1} << 50;
constexpr double series_error_allowed = 1e-10;

tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Sums over any number of blocks, phases about the first stamp: enough for three parameters.
struct Totals {
  double n = 0.0;
  Complex x, xx;
  struct Channel {
    double e = 0.0, ee = 0.0;
    Complex ex;
  };
  std::vector<Channel> channels;

  void add(const DesignSeries& design, const std::vector<ResidualSeries>& residuals) {
    n += design.u[0];
    x += design.x[0];
    xx += design.xx[0];
    for (std::size_t j = 0; j < residuals.size(); ++j) {
      channels[j].e += residuals[j].e;
      channels[j].ee += residuals[j].ee;
      channels[j].ex += residuals[j].ex[0];
    }
  }
  [[nodiscard]] DesignSums design() const { return {-x.imag(), x.real(), 0.5 * (n - xx.real()), -0.5 * xx.imag()}; }
  [[nodiscard]] ResidualSums residuals(std::size_t j) const {
    return {channels[j].e, -channels[j].ex.imag(), channels[j].ex.real(), channels[j].ee};
  }
};

struct Block {
  DesignSeries design;
  std::vector<ResidualSeries> channels;
  double half_length_s = 0.0;
};

} // namespace

class SineStream::State {
public:
  State(const Frequency& frequency, std::size_t channels) : frequency_(frequency), values_(channels), start_(channels) {
    totals_.channels.resize(channels);
  }

  Expected<void> push(std::span<const std::int64_t> stamps, std::span<const std::span<const double>> channels);
  [[nodiscard]] std::uint64_t samples() const { return static_cast<std::uint64_t>(totals_.n) + filled_; }
  [[nodiscard]] Expected<std::vector<SineFit>> fit(std::int64_t reference_ns) const;
  [[nodiscard]] Expected<FrequencyFit> fit_with_frequency(double search_rel, std::int64_t reference_ns) const;

private:
  [[nodiscard]] Expected<void> check(std::span<const std::int64_t> stamps, std::span<const std::span<const double>> channels) const;
  [[nodiscard]] Expected<void> ready(std::size_t parameters) const;
  [[nodiscard]] Expected<std::int64_t> shift_to(std::int64_t reference_ns) const;
  [[nodiscard]] Block reduce() const;
  void add_open_block(Totals& totals) const;
  [[nodiscard]] std::size_t without_gap(std::span<const std::int64_t> stamps);
  void close_block();
  void choose_start();
  [[nodiscard]] double span_s() const { return static_cast<double>(last_ns_ - first_ns_) * 1e-9; }
  [[nodiscard]] double search(std::span<const Segment> segments, double half_range) const;
  void add_spectra(std::span<const Segment> segments, double step, int half, std::vector<double>& merit) const;
  [[nodiscard]] double misfit(std::span<const Segment> segments, double delta, ShiftedSums& sums) const;

  Frequency frequency_;
  std::array<std::int64_t, block_length> stamps_{};
  std::vector<std::array<double, block_length>> values_;
  std::size_t filled_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t last_interval_ns_ = std::numeric_limits<std::int64_t>::max();
  std::vector<Parameters> start_; // about the first stamp
  Totals totals_;
  std::deque<Block> blocks_;
  double highest_rate_hz_ = 0.0; // mean of a block
};

Expected<void> SineStream::State::check(std::span<const std::int64_t> stamps, std::span<const std::span<const double>> channels) const {
  if (channels.size() != values_.size()) {
    return fail(ErrorCode::invalid_argument,
                "the stream has " + std::to_string(values_.size()) + " channels but was given " + std::to_string(channels.size()));
  }
  for (std::size_t j = 0; j < channels.size(); ++j) {
    if (channels[j].size() != stamps.size()) {
      return fail(ErrorCode::invalid_argument, "channel " + std::to_string(j) + " does not have as many samples as there are stamps");
    }
    double residue = 0.0; // y - y is zero or not a number
    for (const double y : channels[j])
      residue += y - y;
    if (residue != 0.0) return fail(ErrorCode::not_finite, "a sample of channel " + std::to_string(j) + " is not a finite number");
  }
  if (stamps.empty()) return {};
  bool increasing = samples() == 0 || stamps[0] > last_ns_;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    increasing &= stamps[i] > stamps[i - 1];
  if (!increasing)
    return fail(ErrorCode::stamps_not_increasing, "a stamp is not later than the one before; remove duplicates and sort by time");
  std::int64_t span = 0;
  const std::int64_t first = samples() == 0 ? stamps[0] : first_ns_;
  if (__builtin_sub_overflow(stamps.back(), first, &span) || span > longest_span_ns) {
    return fail(ErrorCode::invalid_argument, "the stream spans more than 13 days; evaluate it in parts");
  }
  return {};
}

Expected<void> SineStream::State::push(std::span<const std::int64_t> stamps, std::span<const std::span<const double>> channels) {
  if (const auto checked = check(stamps, channels); !checked) return checked;
  if (samples() == 0 && !stamps.empty()) {
    first_ns_ = stamps[0];
    for (std::size_t j = 0; j < start_.size(); ++j)
      start_[j] = {0.0, 0.0, channels[j][0]};
  }
  for (std::size_t i = 0; i < stamps.size();) {
    const std::size_t n = without_gap(stamps.subspan(i, std::min(stamps.size() - i, block_length - filled_)));
    std::copy_n(stamps.data() + i, n, stamps_.data() + filled_);
    for (std::size_t j = 0; j < values_.size(); ++j)
      std::copy_n(channels[j].data() + i, n, values_[j].data() + filled_);
    i += n;
    filled_ += n;
    if (filled_ == block_length || (n == 0 && filled_ > 0)) close_block();
  }
  return {};
}

// How many of the stamps belong to the open block: all, or those before a gap.
std::size_t SineStream::State::without_gap(std::span<const std::int64_t> stamps) {
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const bool first = filled_ + i == 0;
    const std::int64_t interval = stamps[i] - last_ns_;
    if (!first && interval / gap_intervals > last_interval_ns_) return i;
    if (samples() + i > 0) last_interval_ns_ = interval;
    last_ns_ = stamps[i];
  }
  return stamps.size();
}

// Series of the buffered samples: computed about the middle of the block, phases then turned to the first stamp.
Block SineStream::State::reduce() const {
  const SineKernel& kernel = best_kernel();
  const std::int64_t middle_ns = stamps_[0] + (stamps_[filled_ - 1] - stamps_[0]) / 2;
  const double turns = frequency_.reduced_turns(middle_ns - first_ns_);
  const auto [s, c] = sine_cosine_of_turns(turns);
  const Complex back{c, -s};
  const Complex back_twice = times(back, back);
  const TimeAxis axis{frequency_.turns_per_ns_high(), frequency_.turns_per_ns_low(), middle_ns, 1e-9};
  BlockBasis basis;
  DesignMoments moments;
  kernel.design_moments(stamps_.data(), filled_, axis, basis, moments);
  Block block;
  block.half_length_s = static_cast<double>(stamps_[filled_ - 1] - stamps_[0]) * 0.5e-9;
  block.design = design_series(moments, static_cast<double>(middle_ns - first_ns_) * 1e-9);
  for (Complex& x : block.design.x)
    x = times(x, back);
  for (Complex& xx : block.design.xx)
    xx = times(xx, back_twice);
  block.channels.reserve(values_.size());
  for (std::size_t j = 0; j < values_.size(); ++j) {
    const Complex p = times({start_[j].sine, start_[j].cosine}, std::conj(back));
    ResidualMoments residuals;
    kernel.residual_moments(values_[j].data(), filled_, basis, {p.real(), p.imag(), start_[j].offset}, residuals);
    block.channels.push_back(residual_series(residuals));
    for (Complex& ex : block.channels.back().ex)
      ex = times(ex, back);
  }
  return block;
}

// The buffered samples' part of the sums, without their series.
void SineStream::State::add_open_block(Totals& totals) const {
  const std::int64_t middle_ns = stamps_[0] + (stamps_[filled_ - 1] - stamps_[0]) / 2;
  const auto [s, c] = sine_cosine_of_turns(frequency_.reduced_turns(middle_ns - first_ns_));
  const Complex back{c, -s};
  const TimeAxis axis{frequency_.turns_per_ns_high(), frequency_.turns_per_ns_low(), middle_ns, 1e-9};
  std::vector<Parameters> start;
  std::vector<const double*> values;
  for (std::size_t j = 0; j < values_.size(); ++j) {
    const Complex p = times({start_[j].sine, start_[j].cosine}, std::conj(back));
    start.push_back({p.real(), p.imag(), start_[j].offset});
    values.push_back(values_[j].data());
  }
  DesignSums sums;
  std::vector<ResidualSums> residuals(values_.size());
  best_kernel().fit_block(stamps_.data(), filled_, axis, values.data(), values.size(), start.data(), sums, residuals.data());
  const double n = static_cast<double>(filled_);
  totals.n += n;
  totals.x += times({sums.c, -sums.s}, back);
  totals.xx += times({n - 2.0 * sums.ss, -2.0 * sums.sc}, times(back, back));
  for (std::size_t j = 0; j < residuals.size(); ++j) {
    totals.channels[j].e += residuals[j].e;
    totals.channels[j].ee += residuals[j].ee;
    totals.channels[j].ex += times({residuals[j].ec, -residuals[j].es}, back);
  }
}

// A first block that sees enough of a period gives start parameters that leave only noise in the residuals.
void SineStream::State::choose_start() {
  const Block block = reduce();
  Totals totals;
  totals.channels.resize(values_.size());
  totals.add(block.design, block.channels);
  constexpr double enough = 0.05;
  const NormalMatrix matrix(totals.n, totals.design());
  for (std::size_t j = 0; j < start_.size(); ++j) {
    if (matrix.smallest > enough) {
      start_[j] = solve(matrix, totals.residuals(j), start_[j]).p;
    } else {
      start_[j].offset += totals.channels[j].e / totals.n;
    }
  }
}

void SineStream::State::close_block() {
  if (blocks_.empty()) choose_start();
  blocks_.push_back(reduce());
  if (filled_ > 1) {
    highest_rate_hz_ = std::max(highest_rate_hz_, static_cast<double>(filled_ - 1) / (2.0 * blocks_.back().half_length_s));
  }
  totals_.add(blocks_.back().design, blocks_.back().channels);
  filled_ = 0;
}

Expected<void> SineStream::State::ready(std::size_t parameters) const {
  if (samples() <= parameters) {
    return fail(ErrorCode::too_few_samples, "the stream has " + std::to_string(samples()) + " samples, a fit of " +
                                                std::to_string(parameters) + " parameters needs at least " +
                                                std::to_string(parameters + 1));
  }
  if (blocks_.empty()) return {};
  if (frequency_.hz() > 0.5 * highest_rate_hz_) {
    return fail(ErrorCode::frequency_out_of_range, "the frequency of " + std::to_string(frequency_.hz()) +
                                                       " Hz is above half the sample rate of " + std::to_string(highest_rate_hz_) + " Hz");
  }
  return {};
}

Expected<std::int64_t> SineStream::State::shift_to(std::int64_t reference_ns) const {
  std::int64_t shift_ns = 0;
  if (__builtin_sub_overflow(reference_ns, first_ns_, &shift_ns)) {
    return fail(ErrorCode::invalid_argument, "the reference instant is more than 292 years away from the record");
  }
  return shift_ns;
}

Expected<std::vector<SineFit>> SineStream::State::fit(std::int64_t reference_ns) const {
  if (const auto checked = ready(3); !checked) return tl::unexpected(checked.error());
  const auto shift_ns = shift_to(reference_ns);
  if (!shift_ns) return tl::unexpected(shift_ns.error());
  if (blocks_.empty()) {
    std::vector<std::span<const double>> channels;
    for (const auto& values : values_)
      channels.emplace_back(values.data(), filled_);
    return fit_sine(frequency_, reference_ns, {stamps_.data(), filled_}, channels);
  }
  Totals totals = totals_;
  if (filled_ > 0) add_open_block(totals);
  const NormalMatrix matrix(totals.n, totals.design());
  if (!matrix.well_conditioned()) {
    return fail(ErrorCode::ill_conditioned, "sine, cosine and constant of " + std::to_string(frequency_.hz()) +
                                                " Hz cannot be told apart yet; record more of a period");
  }
  const double turns = frequency_.reduced_turns(*shift_ns);
  const std::array<double, 6> unit = unit_covariance(matrix);
  std::vector<SineFit> fits(values_.size());
  bool excited = false;
  for (std::size_t j = 0; j < fits.size(); ++j) {
    const Solution solution = solve(matrix, totals.residuals(j), start_[j]);
    SineFit& fit = fits[j];
    fit.sine = solution.p.sine;
    fit.cosine = solution.p.cosine;
    fit.offset = solution.p.offset;
    fit.rss = solution.rss;
    fit.samples = samples();
    fit.degrees_of_freedom = totals.n - 3.0;
    for (std::size_t i = 0; i < unit.size(); ++i)
      fit.covariance[i] = unit[i] * solution.rss / fit.degrees_of_freedom;
    excited |= stands_out(fit);
    rotate(fit, turns);
  }
  if (!excited) {
    return fail(ErrorCode::no_excitation,
                "no sine of " + std::to_string(frequency_.hz()) + " Hz stands out of the noise in any channel; check frequency and window");
  }
  return fits;
}

double SineStream::State::misfit(std::span<const Segment> segments, double delta, ShiftedSums& sums) const {
  shift_sums(segments, start_, delta, sums);
  const NormalMatrix matrix(sums.n, sums.design);
  if (!matrix.well_conditioned()) return std::numeric_limits<double>::infinity();
  double total = 0.0;
  for (std::size_t j = 0; j < start_.size(); ++j) {
    const Solution solution = solve(matrix, sums.residuals[j], start_[j]);
    total += std::log(solution.rss + 1e-30 * solution.ee + std::numeric_limits<double>::min());
  }
  return total;
}

// Few bins or cycles: the misfit itself on a grid. Many: the phasors of the blocks on a grid, turned step by step; their image
// at -f and the constant average out over the cycles.
double SineStream::State::search(std::span<const Segment> segments, double half_range) const {
  const double bin = 2.0 * std::numbers::pi / span_s();
  constexpr double basin_bins = 0.3;
  constexpr double fewest_bins = 4.0;
  constexpr double fewest_cycles = 8.0;
  if (half_range <= basin_bins * bin) return 0.0;
  const bool few = half_range < fewest_bins * bin || frequency_.angular() - half_range < fewest_cycles * bin;
  const double step_bins = few ? 0.4 : 0.25;
  const int half = static_cast<int>(std::ceil(half_range / (step_bins * bin)));
  const double step = half_range / half;
  std::vector<double> merit(static_cast<std::size_t>(2 * half + 1), 0.0);
  if (few) {
    ShiftedSums sums;
    for (int i = -half; i <= half; ++i)
      merit[static_cast<std::size_t>(i + half)] = -misfit(segments, step * i, sums);
  } else {
    add_spectra(segments, step, half, merit);
  }
  return step * static_cast<double>(std::max_element(merit.begin(), merit.end()) - merit.begin() - half);
}

void SineStream::State::add_spectra(std::span<const Segment> segments, double step, int half, std::vector<double>& merit) const {
  // With the start parameters put back: the phasors of the values, less the constant.
  std::vector<Complex> turned(segments.size()), turn(segments.size());
  for (std::size_t j = 0; j < start_.size(); ++j) {
    const Complex p{start_[j].sine, start_[j].cosine};
    double square = totals_.channels[j].ee;
    for (std::size_t k = 0; k < segments.size(); ++k) {
      const double centre = segments[k].design->centre;
      const double n = segments[k].design->u[0];
      turn[k] = std::polar(1.0, -step * centre);
      turned[k] = times(segments[k].channels[j].ex[0] + times({0.0, -0.5 * n}, p), std::polar(1.0, step * half * centre));
      square += 0.5 * n * std::norm(p);
    }
    for (double& value : merit) {
      Complex sum = 0.0;
      for (std::size_t k = 0; k < segments.size(); ++k) {
        sum += turned[k];
        turned[k] = times(turned[k], turn[k]);
      }
      const double explained = 2.0 * std::norm(sum) / (static_cast<double>(samples()) * (square + std::numeric_limits<double>::min()));
      value -= std::log1p(-std::min(explained, 1.0 - 1e-12));
    }
  }
}

Expected<FrequencyFit> SineStream::State::fit_with_frequency(double search_rel, std::int64_t reference_ns) const {
  if (const auto checked = ready(4); !checked) return tl::unexpected(checked.error());
  if (!(search_rel >= 0.0 && search_rel < 1.0)) {
    return fail(ErrorCode::invalid_argument, "the search range of the frequency must be at least 0 and below 1, relative to the start");
  }
  const auto shift_ns = shift_to(reference_ns);
  if (!shift_ns) return tl::unexpected(shift_ns.error());
  std::vector<Segment> segments;
  double half_length_s = 0.0;
  const auto take = [&](const Block& block) {
    segments.push_back({&block.design, block.channels.data()});
    half_length_s = std::max(half_length_s, block.half_length_s);
  };
  for (const Block& block : blocks_)
    take(block);
  const Block last = filled_ > 0 ? reduce() : Block{};
  if (filled_ > 0) take(last);

  const double bin = 2.0 * std::numbers::pi / span_s();
  const double half_range = search_rel * frequency_.angular();
  const FrequencySolution solution =
      solve_frequency(segments, start_, search(segments, half_range), half_range + 2.0 * bin, 1e-12 / span_s());
  if (!solution.matrix.well_conditioned() || !std::isfinite(solution.u_delta)) {
    return fail(ErrorCode::ill_conditioned,
                "frequency, sine, cosine and constant cannot be told apart in this record; record more periods");
  }
  const double moved = std::abs(solution.delta) * half_length_s;
  FrequencyFit result{
      frequency_.shifted_by_hz(solution.delta / (2.0 * std::numbers::pi)), solution.u_delta / (2.0 * std::numbers::pi), {}, 1};
  if (!solution.settled || std::pow(2.0 * moved, 7) / 5040.0 > series_error_allowed) {
    return fail(ErrorCode::not_converged, "the frequency moved to " + std::to_string(result.frequency.hz()) +
                                              " Hz, too far from where the stream was reduced; start it at that frequency");
  }
  const double turns = result.frequency.reduced_turns(*shift_ns);
  const double half_span_s = 0.5 * span_s();
  bool excited = false;
  for (std::size_t j = 0; j < start_.size(); ++j) {
    const double to_middle = result.frequency.reduced_turns((last_ns_ - first_ns_) / 2);
    excited |= stands_out(channel_fit(solution, j, half_span_s, to_middle), 1.0 + 2.0 * half_range / bin);
    result.channels.push_back(channel_fit(solution, j, static_cast<double>(*shift_ns) * 1e-9, turns));
  }
  if (!excited) {
    return fail(ErrorCode::no_excitation, "no sine near " + std::to_string(frequency_.hz()) +
                                              " Hz stands out of the noise in any channel; check frequency, search range and window");
  }
  return result;
}

SineStream::SineStream(const Frequency& frequency, std::size_t channels) : state_(std::make_unique<State>(frequency, channels)) {}
SineStream::SineStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
SineStream::SineStream(SineStream&&) noexcept = default;
SineStream& SineStream::operator=(SineStream&&) noexcept = default;
SineStream::~SineStream() = default;

SineStream SineStream::clone() const {
  return SineStream(std::make_unique<State>(*state_));
}

Expected<void> SineStream::push(std::span<const std::int64_t> stamps_ns, std::span<const std::span<const double>> channels) {
  return state_->push(stamps_ns, channels);
}
std::uint64_t SineStream::samples() const {
  return state_->samples();
}
Expected<std::vector<SineFit>> SineStream::fit(std::int64_t reference_ns) const {
  return state_->fit(reference_ns);
}
Expected<FrequencyFit> SineStream::fit_with_frequency(double search_rel, std::int64_t reference_ns) const {
  return state_->fit_with_frequency(search_rel, reference_ns);
}

} // namespace dyncal::analysis
