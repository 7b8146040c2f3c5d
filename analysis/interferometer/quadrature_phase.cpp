#include "analysis/interferometer/quadrature_phase.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

namespace dyncal::analysis {
namespace {

constexpr std::size_t phase_block = 1024;
constexpr unsigned radius_mean_samples = 16;
constexpr double doubtful_turns = 0.25;

using PhaseOfInt16 = kernel::QuadraturePhase<std::int16_t>;
using PhaseOfFloat = kernel::QuadraturePhase<float>;
using PhaseOfDouble = kernel::QuadraturePhase<double>;

PhaseOfInt16 phase_function(const kernel::QuadratureKernel& best, std::int16_t) {
  return best.phase_of_int16;
}
PhaseOfFloat phase_function(const kernel::QuadratureKernel& best, float) {
  return best.phase_of_float;
}
PhaseOfDouble phase_function(const kernel::QuadratureKernel& best, double) {
  return best.phase_of_double;
}

} // namespace

std::optional<double> PhaseStatistics::radius_ratio() const {
  if (!(max_radius_squared > 0.0) || min_radius_squared > max_radius_squared) {
    return std::nullopt;
  }
  return std::sqrt(min_radius_squared / max_radius_squared);
}

Expected<void> QuadraturePhase::see_radius(std::span<const double> turns,
                                           const double* radius_squared) {
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double square = radius_squared[i];
    if (!(square < std::numeric_limits<double>::infinity())) {
      return fail(ErrorCode::not_finite, "sample " + std::to_string(statistics_.samples + i) +
                                             " of the interferometer is not finite");
    }
    radius_over_phase_.add(turns[i], square);
    radius_sum_ += square;
    if (++radius_samples_ == radius_mean_samples) {
      const double mean = radius_sum_ / radius_mean_samples;
      statistics_.min_radius_squared = std::min(statistics_.min_radius_squared, mean);
      statistics_.max_radius_squared = std::max(statistics_.max_radius_squared, mean);
      radius_sum_ = 0.0;
      radius_samples_ = 0;
    }
  }
  return {};
}

void QuadraturePhase::unwrap(std::span<double> turns) {
  // A rounding to the nearest integer that needs no instruction of its own: 1.5 * 2^52.
  constexpr double shift = 6755399441055744.0;
  PhaseStatistics seen = statistics_;
  Unwrapping at = unwrapping_;
  for (double& phase : turns) {
    if (at.samples == 0) {
      at.last_turns = phase;
    }
    const double step = phase - at.last_turns;
    const double change = step - at.last_step;
    const double whole = (change + shift) - shift;
    const double error = at.samples < 2 ? 0.0 : std::abs(change - whole); // expected nothing yet
    at.last_turns = phase;
    at.last_step = step;
    at.whole_steps += static_cast<std::int64_t>(whole);
    at.whole_turns += at.whole_steps;
    phase = (phase - static_cast<double>(at.whole_turns)) + at.offset;
    seen.doubtful += error > doubtful_turns ? 1 : 0;
    seen.max_prediction_error = std::max(seen.max_prediction_error, error);
    seen.min_turns = std::min(seen.min_turns, phase);
    seen.max_turns = std::max(seen.max_turns, phase);
    ++seen.samples;
    ++at.samples;
  }
  statistics_ = seen;
  unwrapping_ = at;
}

void QuadraturePhase::adopt(const Ellipse& ellipse) {
  correction_ = correction_of(ellipse);
  radius_over_phase_ = {};
  radius_sum_ = 0.0;
  radius_samples_ = 0;
  forget_extremes();
  if (unwrapping_.samples == 0) {
    return;
  }
  double turns = 0.0;
  double radius_squared = 0.0;
  kernel::best_quadrature_kernel().phase_of_double(&last_u1_, &last_u2_, 1, correction_, &turns,
                                                   &radius_squared);
  const double change = turns - unwrapping_.last_turns;
  const double whole = std::round(change);
  unwrapping_.last_turns = turns;
  unwrapping_.whole_turns += static_cast<std::int64_t>(whole);
  unwrapping_.offset -= change - whole;
}

void QuadraturePhase::begin_again() {
  unwrapping_.samples = 0;
  unwrapping_.last_step = 0.0;
  unwrapping_.whole_steps = 0;
}

void QuadraturePhase::forget_extremes() {
  const PhaseStatistics none;
  statistics_.min_turns = none.min_turns;
  statistics_.max_turns = none.max_turns;
  statistics_.min_radius_squared = none.min_radius_squared;
  statistics_.max_radius_squared = none.max_radius_squared;
}

template <class Number>
Expected<void> QuadraturePhase::push_samples(std::span<const Number> u1, std::span<const Number> u2,
                                             std::span<double> turns) {
  assert(u1.size() == u2.size() && u1.size() == turns.size());
  const auto phase_of = phase_function(kernel::best_quadrature_kernel(), Number{});
  alignas(64) double radius_squared[phase_block];
  for (std::size_t begin = 0; begin < u1.size(); begin += phase_block) {
    const std::size_t n = std::min(phase_block, u1.size() - begin);
    const std::span<double> block = turns.subspan(begin, n);
    phase_of(&u1[begin], &u2[begin], n, correction_, block.data(), radius_squared);
    DYNCAL_TRY(see_radius(block, radius_squared));
    unwrap(block);
  }
  if (!u1.empty()) {
    last_u1_ = static_cast<double>(u1.back());
    last_u2_ = static_cast<double>(u2.back());
  }
  return {};
}

Expected<void> QuadraturePhase::push(std::span<const std::int16_t> u1,
                                     std::span<const std::int16_t> u2, std::span<double> turns) {
  return push_samples(u1, u2, turns);
}

Expected<void> QuadraturePhase::push(std::span<const float> u1, std::span<const float> u2,
                                     std::span<double> turns) {
  return push_samples(u1, u2, turns);
}

Expected<void> QuadraturePhase::push(std::span<const double> u1, std::span<const double> u2,
                                     std::span<double> turns) {
  return push_samples(u1, u2, turns);
}

} // namespace dyncal::analysis
