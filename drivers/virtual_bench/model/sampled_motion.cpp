#include "drivers/virtual_bench/model/sampled_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

std::complex<double> carrier_at(const ExcitationSegment& segment, double from_begin_s) {
  const double turns = segment.turns + from_begin_s * segment.frequency_hz;
  return std::polar(1.0, two_pi * (turns - std::floor(turns)));
}

} // namespace

// The first one that is not before `time_s`.
std::uint64_t SampledMotion::first_sample_at(double time_s) const {
  auto sample = static_cast<std::uint64_t>(std::max(0.0, std::floor(time_s / interval_s_) - 1.0));
  while (static_cast<double>(sample) * interval_s_ < time_s) {
    ++sample;
  }
  return sample;
}

const SampledMotion::Powers& SampledMotion::powers_of(std::size_t line,
                                                      const ExcitationSegment& segment) {
  powers_.resize(std::max(powers_.size(), line + 1));
  Powers& powers = powers_[line];
  if (powers.frequency_hz == segment.frequency_hz && powers.decay_s == segment.decay_s) {
    return powers;
  }
  powers.frequency_hz = segment.frequency_hz;
  powers.decay_s = segment.decay_s;
  for (std::size_t k = 0; k < block_samples; ++k) {
    const double after_s = static_cast<double>(k) * interval_s_;
    powers.cosine[k] = std::cos(two_pi * segment.frequency_hz * after_s);
    powers.sine[k] = std::sin(two_pi * segment.frequency_hz * after_s);
    powers.left[k] = std::exp(-after_s / segment.decay_s);
    powers.returned[k] = std::exp(-after_s / Excitation::suspension_s);
  }
  return powers;
}

void SampledMotion::sample(std::uint64_t from, std::uint64_t to, const Excitation& excitation,
                           Block& displacement_m, Block& sync_v) {
  const std::uint64_t first = from / block_samples * block_samples;
  const auto begin = static_cast<std::size_t>(from - first);
  const auto end = static_cast<std::size_t>(to - first);
  std::fill(displacement_m.begin() + begin, displacement_m.begin() + end, 0.0);
  std::fill(sync_v.begin() + begin, sync_v.begin() + end, 0.0);
  for (std::size_t line = 0; line < excitation.lines(); ++line) {
    const Excitation::Line& segments = excitation.segments(line);
    std::uint64_t until = to;
    for (std::size_t i = segments.size(); i-- > 0 && until > from;) {
      const std::uint64_t since = i == 0 ? from : first_sample_at(segments[i].begin_s);
      if (since < until) {
        const Place place{first, static_cast<std::size_t>(std::max(since, from) - first),
                          static_cast<std::size_t>(until - first)};
        add_segment(place, excitation, segments[i], powers_of(line, segments[i]), displacement_m,
                    sync_v);
        until = std::max(since, from);
      }
    }
  }
}

void SampledMotion::add_segment(const Place& place, const Excitation& excitation,
                                const ExcitationSegment& segment, const Powers& powers,
                                Block& displacement_m, Block& sync_v) const {
  DisplacementTerms terms =
      displacement_terms(segment, excitation.second_harmonic(), excitation.third_harmonic());
  terms.settled *= spot_;
  terms.changing *= spot_;
  const double block_s = static_cast<double>(place.first) * interval_s_;
  const double from_begin_s = block_s - delay_s_ - segment.begin_s;
  const std::complex<double> moved = carrier_at(segment, from_begin_s);
  const std::complex<double> sync =
      sync_.of(segment) * carrier_at(segment, block_s - segment.begin_s);
  // Of a segment that began within this block these are more than 1, and 1 at its beginning.
  const double left = std::exp(-from_begin_s / segment.decay_s);
  const double returned = std::exp(-from_begin_s / Excitation::suspension_s);
  const double wander = excitation.wandering(block_s);
  const double wander_step =
      (excitation.wandering(block_s + static_cast<double>(block_samples) * interval_s_) - wander) /
      static_cast<double>(block_samples);
  const std::complex<double> change = segment.initial - segment.target;
  for (std::size_t k = place.from; k < place.to; ++k) {
    const std::complex<double> step(powers.cosine[k], powers.sine[k]);
    const double re = moved.real() * step.real() - moved.imag() * step.imag();
    const double im = moved.real() * step.imag() + moved.imag() * step.real();
    const double left_now = left * powers.left[k];
    const double settled_re = terms.settled.real() + terms.changing.real() * left_now;
    const double settled_im = terms.settled.imag() + terms.changing.imag() * left_now;
    const double envelope_re = segment.target.real() + change.real() * left_now;
    const double envelope_im = segment.target.imag() + change.imag() * left_now;
    const double envelope = std::sqrt(envelope_re * envelope_re + envelope_im * envelope_im);
    // (second + third c) c^2
    const double high_re = terms.second.real() + terms.third.real() * re - terms.third.imag() * im;
    const double high_im = terms.second.imag() + terms.third.real() * im + terms.third.imag() * re;
    const double harmonics = high_re * 2.0 * re * im + high_im * (re * re - im * im);
    const double now_s = from_begin_s + static_cast<double>(k) * interval_s_;
    displacement_m[k] +=
        (wander + wander_step * static_cast<double>(k)) *
            (settled_re * im + settled_im * re + envelope * harmonics) +
        (segment.position_m + terms.return_m_s * now_s) * returned * powers.returned[k];
    sync_v[k] += sync.real() * step.imag() + sync.imag() * step.real();
  }
}

} // namespace dyncal::drivers::virtual_bench
