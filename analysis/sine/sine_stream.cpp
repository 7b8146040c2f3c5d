#include "analysis/sine/sine_stream.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/sine/sine_stream_state.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::int64_t gap_intervals =
    64; // a block ends before an interval this many times the one before
constexpr std::int64_t max_span_ns = std::int64_t{1} << 50;

} // namespace

using namespace kernel;

Expected<void> SineStream::State::check(std::span<const std::int64_t> stamps,
                                        std::span<const std::span<const double>> channels) const {
  if (channels.size() != samples_.values.size()) {
    return fail(ErrorCode::invalid_argument,
                "the stream has " + std::to_string(samples_.values.size()) +
                    " channels but was given " + std::to_string(channels.size()));
  }
  for (std::size_t j = 0; j < channels.size(); ++j) {
    if (channels[j].size() != stamps.size()) {
      return fail(ErrorCode::invalid_argument,
                  "channel " + std::to_string(j) +
                      " does not have as many samples as there are stamps");
    }
    double residue = 0.0; // y - y is zero or not a number
    for (const double y : channels[j]) {
      residue += y - y;
    }
    if (residue != 0.0) {
      return fail(ErrorCode::not_finite,
                  "a sample of channel " + std::to_string(j) + " is not a finite number");
    }
  }
  if (stamps.empty()) {
    return {};
  }
  bool increasing = samples() == 0 || stamps[0] > last_ns_;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    increasing &= stamps[i] > stamps[i - 1];
  }
  if (!increasing) {
    return fail(ErrorCode::stamps_not_increasing,
                "a stamp is not later than the one before; remove duplicates and sort by time");
  }
  std::int64_t span = 0;
  const std::int64_t first = samples() == 0 ? stamps[0] : first_ns_;
  if (__builtin_sub_overflow(stamps.back(), first, &span) || span > max_span_ns) {
    return fail(ErrorCode::invalid_argument,
                "the stream spans more than 13 days; evaluate it in parts");
  }
  return {};
}

Expected<void> SineStream::State::push(std::span<const std::int64_t> stamps,
                                       std::span<const std::span<const double>> channels) {
  if (auto checked = check(stamps, channels); !checked) {
    return checked;
  }
  if (samples() == 0 && !stamps.empty()) {
    first_ns_ = stamps[0];
    for (std::size_t j = 0; j < start_.size(); ++j) {
      start_[j] = {0.0, 0.0, channels[j][0]};
    }
  }
  if (reduction_.pending()) {
    reduce_piece();
  }
  for (std::size_t i = 0; i < stamps.size();) {
    const std::size_t n = without_gap(
        stamps.subspan(i, std::min(stamps.size() - i, BlockSamples::capacity - samples_.filled)));
    std::copy_n(stamps.data() + i, n, samples_.stamps.data() + samples_.filled);
    for (std::size_t j = 0; j < samples_.values.size(); ++j) {
      std::copy_n(channels[j].data() + i, n, samples_.values[j].data() + samples_.filled);
    }
    i += n;
    samples_.filled += n;
    if (samples_.filled >= BlockSamples::capacity / 2) {
      prepare_block();
    }
    if (samples_.filled == BlockSamples::capacity || (n == 0 && samples_.filled > 0)) {
      close_block();
    }
  }
  return {};
}

// How many of the stamps belong to the open block: all, or those before a gap.
std::size_t SineStream::State::without_gap(std::span<const std::int64_t> stamps) {
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const bool first = samples_.filled + i == 0;
    const std::int64_t interval = stamps[i] - last_ns_;
    if (!first && interval / gap_intervals > last_interval_ns_) {
      return i;
    }
    if (samples() + i > 0) {
      last_interval_ns_ = interval;
    }
    last_ns_ = stamps[i];
  }
  return stamps.size();
}

void kernel::BlockReduction::take_piece(const BlockSamples& samples, const Frequency& frequency,
                                        std::int64_t first_ns, std::span<const Parameters> start,
                                        Block& block) {
  const SineKernel& kernel = best_kernel();
  if (pieces_-- == start.size() + 1) {
    const auto [s, c] =
        sine_cosine_of_turns(frequency.reduced_turns(samples.middle_ns() - first_ns));
    back_ = {c, -s};
    const Complex back_twice = times(back_, back_);
    const TimeAxis axis{frequency.turns_per_ns_high(), frequency.turns_per_ns_low(),
                        samples.middle_ns(), 1e-9};
    DesignMoments moments;
    kernel.design_moments(samples.stamps.data(), samples.filled, axis, basis_, moments);
    block.half_length_s = samples.half_length_s();
    block.design = design_frequency_series(
        moments, static_cast<double>(samples.middle_ns() - first_ns) * 1e-9);
    for (Complex& x : block.design.x) {
      x = times(x, back_);
    }
    for (Complex& xx : block.design.xx) {
      xx = times(xx, back_twice);
    }
    return;
  }
  const std::size_t j = pieces_;
  const Complex p = times({start[j].sine, start[j].cosine}, std::conj(back_));
  ResidualMoments residuals;
  kernel.residual_moments(samples.values[j].data(), samples.filled, basis_,
                          {p.real(), p.imag(), start[j].offset}, residuals);
  block.channels[j] = residual_frequency_series(residuals);
  for (Complex& ex : block.channels[j].ex) {
    ex = times(ex, back_);
  }
}

void SineStream::State::reduce_piece() {
  reduction_.take_piece(full_, frequency_, first_ns_, start_, blocks_[closed_ - 1]);
}

// All sums so far, the buffered samples' without their series.
const Totals& SineStream::State::totals_with_open_block() {
  if (samples_.filled == 0) {
    return totals_;
  }
  Totals& totals = open_.totals;
  totals = totals_;
  const std::int64_t middle_ns = samples_.middle_ns();
  const auto [s, c] = sine_cosine_of_turns(frequency_.reduced_turns(middle_ns - first_ns_));
  const Complex back{c, -s};
  const TimeAxis axis{frequency_.turns_per_ns_high(), frequency_.turns_per_ns_low(), middle_ns,
                      1e-9};
  for (std::size_t j = 0; j < samples_.values.size(); ++j) {
    const Complex p = times({start_[j].sine, start_[j].cosine}, std::conj(back));
    open_.start[j] = {p.real(), p.imag(), start_[j].offset};
    open_.values[j] = samples_.values[j].data();
  }
  DesignSums sums;
  const std::vector<ResidualSums>& residuals = open_.residuals;
  best_kernel().fit_block(samples_.stamps.data(), samples_.filled, axis, open_.values.data(),
                          samples_.values.size(), open_.start.data(), sums, open_.residuals.data());
  const double n = static_cast<double>(samples_.filled);
  totals.n += n;
  totals.x += times({sums.c, -sums.s}, back);
  totals.xx += times({n - 2.0 * sums.ss, -2.0 * sums.sc}, times(back, back));
  for (std::size_t j = 0; j < residuals.size(); ++j) {
    totals.channels[j].e += residuals[j].e;
    totals.channels[j].ee += residuals[j].ee;
    totals.channels[j].ex += times({residuals[j].ec, -residuals[j].es}, back);
  }
  return totals;
}

// A first block that sees enough of a period gives start parameters that leave only noise in the
// residuals.
void SineStream::State::choose_start() {
  const Totals& totals = totals_with_open_block();
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

// Half a block before the memory is needed: the sample that closes a block has enough to do.
void SineStream::State::prepare_block() {
  if (blocks_.size() > closed_) {
    return;
  }
  blocks_.emplace_back();
  blocks_.back().channels.resize(samples_.values.size());
}

void SineStream::State::close_block() {
  while (reduction_.pending()) {
    reduce_piece();
  }
  if (closed_ == 0) {
    choose_start();
  }
  prepare_block();
  totals_ = totals_with_open_block();
  std::swap(samples_, full_);
  samples_.filled = 0;
  if (full_.filled > 1) {
    max_rate_hz_ = std::max(max_rate_hz_,
                            static_cast<double>(full_.filled - 1) / (2.0 * full_.half_length_s()));
  }
  ++closed_;
  reduction_.begin(start_.size());
}

Expected<void> SineStream::State::ready(std::size_t parameters) const {
  if (samples() <= parameters) {
    return fail(ErrorCode::too_few_samples, "the stream has " + std::to_string(samples()) +
                                                " samples, a fit of " + std::to_string(parameters) +
                                                " parameters needs at least " +
                                                std::to_string(parameters + 1));
  }
  if (closed_ == 0) {
    return {};
  }
  if (frequency_.hz() > 0.5 * max_rate_hz_) {
    return fail(ErrorCode::frequency_out_of_range,
                "the frequency of " + std::to_string(frequency_.hz()) +
                    " Hz is above half the sample rate of " + std::to_string(max_rate_hz_) + " Hz");
  }
  return {};
}

Expected<std::int64_t> SineStream::State::shift_to(std::int64_t phase_origin_ns) const {
  std::int64_t shift_ns = 0;
  if (__builtin_sub_overflow(phase_origin_ns, first_ns_, &shift_ns)) {
    return fail(ErrorCode::invalid_argument,
                "the phase origin is more than 292 years away from the record");
  }
  return shift_ns;
}

Expected<std::vector<SineFit>> SineStream::State::fit(std::int64_t phase_origin_ns) {
  if (const auto checked = ready(3); !checked) {
    return fail(checked.error());
  }
  const auto shift_ns = shift_to(phase_origin_ns);
  if (!shift_ns) {
    return fail(shift_ns.error());
  }
  if (closed_ == 0) {
    std::vector<std::span<const double>> channels;
    for (const auto& values : samples_.values) {
      channels.emplace_back(values.data(), samples_.filled);
    }
    return fit_sine(frequency_, phase_origin_ns, {samples_.stamps.data(), samples_.filled},
                    channels);
  }
  const Totals& totals = totals_with_open_block();
  const NormalMatrix matrix(totals.n, totals.design());
  if (!matrix.well_conditioned()) {
    return fail(ErrorCode::ill_conditioned,
                "sine, cosine and constant of " + std::to_string(frequency_.hz()) +
                    " Hz cannot be told apart yet; record more of a period");
  }
  const double turns = frequency_.reduced_turns(*shift_ns);
  const std::array<double, 6> unit = unit_covariance(matrix);
  std::vector<SineFit> fits(samples_.values.size());
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
    for (std::size_t i = 0; i < unit.size(); ++i) {
      fit.covariance[i] = unit[i] * solution.rss / fit.degrees_of_freedom;
    }
    excited |= is_significant(fit);
    rotate(fit, turns);
  }
  if (!excited) {
    return fail(ErrorCode::no_excitation,
                "no sine of " + std::to_string(frequency_.hz()) +
                    " Hz stands out of the noise in any channel; check frequency and window");
  }
  return fits;
}

SineStream::SineStream(const Frequency& frequency, std::size_t channels)
    : state_(std::make_unique<State>(frequency, channels)) {}
SineStream::SineStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
SineStream::SineStream(SineStream&&) noexcept = default;
SineStream& SineStream::operator=(SineStream&&) noexcept = default;
SineStream::~SineStream() = default;

SineStream SineStream::clone() const {
  return SineStream(std::make_unique<State>(*state_));
}

Expected<void> SineStream::push(std::span<const std::int64_t> stamps_ns,
                                std::span<const std::span<const double>> channels) {
  return state_->push(stamps_ns, channels);
}
std::uint64_t SineStream::samples() const {
  return state_->samples();
}
Expected<std::vector<SineFit>> SineStream::fit(std::int64_t phase_origin_ns) const {
  return state_->fit(phase_origin_ns);
}
Expected<FrequencyFit> SineStream::fit_with_frequency(double search_rel,
                                                      std::int64_t phase_origin_ns) const {
  return state_->fit_with_frequency(search_rel, phase_origin_ns);
}

} // namespace dyncal::analysis
