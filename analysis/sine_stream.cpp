#include "analysis/sine_stream.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/sine_stream_state.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::int64_t gap_intervals = 64; // a block ends before an interval this many times the one before
constexpr std::int64_t longest_span_ns = std::int64_t{1} << 50;

} // namespace

using namespace kernel;

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
