#include "drivers/virtual_bench/model/interferometer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double counts_per_range = 8192.0; // 14 bits
constexpr double range_v = 1.0;             // of u1 and u2
constexpr double sync_range_v = 10.0;
constexpr double scale_v = range_v / counts_per_range;
constexpr double sync_scale_v = sync_range_v / counts_per_range;
constexpr std::size_t channel_count = 3;
constexpr double radius_v = 0.64;
constexpr double usual_offset = 0.03; // parts of the radius
constexpr double usual_gain_error = 0.05;
constexpr double usual_quadrature_error_rad = 5.0 * std::numbers::pi / 180.0;
constexpr double noise = 2e-3; // parts of the radius
constexpr double sync_noise_v = 0.6e-3;

double about(Random& random, double usual) {
  return usual * random.uniform(0.5, 1.5) * (random.happens(0.5) ? 1.0 : -1.0);
}

InterferometerTruth draw(const InterferometerSettings& settings, std::uint64_t seed) {
  Random random(seed, "interferometer");
  InterferometerTruth truth;
  truth.radius_v = radius_v;
  truth.p_v = radius_v * about(random, usual_offset);
  truth.q_v = radius_v * about(random, usual_offset);
  truth.r = 1.0 + about(random, usual_gain_error);
  truth.alpha_rad = about(random, usual_quadrature_error_rad);
  truth.wavelength_m = settings.wavelength_m * (1.0 + random.normal(settings.u_wavelength_rel));
  truth.phase_0_rad = random.uniform(0.0, two_pi);
  truth.detector_delay_s = random.uniform(0.0, 1.0 / (two_pi * settings.detector_bandwidth_hz));
  truth.skew_s = random.normal(settings.u_skew_s);
  return truth;
}

std::int32_t to_counts(double value, double scale) {
  return static_cast<std::int32_t>(
      std::clamp(std::rint(value / scale), -counts_per_range, counts_per_range - 1.0));
}

} // namespace

Interferometer::Interferometer(const InterferometerSettings& settings, std::uint64_t seed,
                               double interval_s, const SyncLevel& sync)
    : truth_(draw(settings, seed)), drift_(seed),
      motion_(interval_s, truth_.detector_delay_s, settings.spot, sync),
      noise_(seed, "interferometer noise"), interval_s_(interval_s),
      turns_per_m_(2.0 * settings.passes / truth_.wavelength_m) {}

std::vector<AcsChannel> Interferometer::channels() {
  return {{"u1", "Voltage", "\\volt", range_v, scale_v},
          {"u2", "Voltage", "\\volt", range_v, scale_v},
          {"sync", "Voltage", "\\volt", sync_range_v, sync_scale_v}};
}

void Interferometer::sample(std::uint64_t from, std::uint64_t to, const Excitation& excitation,
                            std::vector<std::int32_t>& counts) {
  constexpr std::uint64_t block = SampledMotion::block_samples;
  while (from < to) {
    const std::uint64_t first = from / block * block;
    const std::uint64_t end = std::min(to, first + block);
    motion_.sample(from, end, excitation, displacement_m_, sync_v_);
    // In a straight line within the block: wrong by picometres.
    const double first_s = static_cast<double>(first) * interval_s_;
    const double drift_m = drift_.at(first_s);
    const double drift_step_m =
        (drift_.at(first_s + static_cast<double>(block) * interval_s_) - drift_m) /
        static_cast<double>(block);
    for (std::size_t k = from - first; k < end - first; ++k) {
      displacement_m_[k] += drift_m + drift_step_m * static_cast<double>(k);
    }
    const std::size_t before = counts.size();
    counts.resize(before + (end - from) * channel_count);
    digitise(from - first, end - first, counts.data() + before);
    from = end;
  }
}

void Interferometer::digitise(std::size_t from, std::size_t to, std::int32_t* counts) {
  const double noise_v = noise * truth_.radius_v;
  const double radius_2_v = truth_.radius_v / truth_.r;
  const double sine_alpha = std::sin(truth_.alpha_rad);
  const double cosine_alpha = std::cos(truth_.alpha_rad);
  const double phase_of_skew = two_pi * truth_.skew_s / interval_s_; // of a turn per sample
  for (std::size_t k = from; k < to; ++k, counts += channel_count) {
    const double turns = turns_per_m_ * displacement_m_[k] + truth_.phase_0_rad / two_pi;
    const double angle = two_pi * (turns - std::rint(turns));
    const double sine = std::sin(angle);
    const double cosine = std::cos(angle);
    // phi - alpha, and how far the phase goes on until u2 is taken.
    const double late = phase_of_skew * (turns - last_turns_);
    const double sine_2 = sine * cosine_alpha - cosine * sine_alpha;
    const double cosine_2 = cosine * cosine_alpha + sine * sine_alpha;
    const double late_sine_2 =
        sine_2 * (1.0 - late * late / 2.0) + cosine_2 * late * (1.0 - late * late / 6.0);
    last_turns_ = turns;
    const std::uint64_t random = noise_.bits();
    const double u1 = truth_.p_v + truth_.radius_v * cosine + noise_v * normal_.at(random);
    const double u2 =
        truth_.q_v + radius_2_v * late_sine_2 + noise_v * normal_.at(random >> NormalTable::bits);
    const double sync = sync_v_[k] + sync_noise_v * normal_.at(random >> (2 * NormalTable::bits));
    counts[0] = to_counts(u1, scale_v);
    counts[1] = to_counts(u2, scale_v);
    counts[2] = to_counts(sync, sync_scale_v);
  }
}

} // namespace dyncal::drivers::virtual_bench
