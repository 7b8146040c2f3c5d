#include "drivers/virtual_bench/model/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

} // namespace

std::complex<double> ExciterModel::at(double frequency_hz) const {
  // A first-order amplifier and armature with a delay, and the rise towards a resonance far above.
  const double rise = 1.0 + 0.1 * (frequency_hz / corner_hz) * (frequency_hz / corner_hz);
  const double lag_rad = std::atan(frequency_hz / corner_hz) + two_pi * frequency_hz * delay_s;
  return std::polar(acceleration_per_volt * rise, -lag_rad);
}

HarmonicGains harmonic_gains(const AxisResponse& response, double frequency_hz) {
  return {response.magnitude_at(frequency_hz) *
              std::polar(1.0, response.residual_phase_at(frequency_hz)),
          response.magnitude_at(2.0 * frequency_hz), response.magnitude_at(3.0 * frequency_hz)};
}

const Excitation::Segment& Excitation::segment_at(double time_s) const {
  std::size_t i = segments_.size() - 1;
  while (i > 0 && segments_[i].begin_s > time_s) {
    --i;
  }
  return segments_[i];
}

std::complex<double> Excitation::envelope(const Segment& segment, double time_s) const {
  const double x =
      (time_s - segment.begin_s) / (segment.on ? exciter_.settling_time_s : exciter_.ring_down_s);
  if (x > 40.0) {
    return segment.target;
  }
  return segment.target + (segment.initial - segment.target) * std::exp(-std::max(x, 0.0));
}

double Excitation::wandering(double time_s) const {
  return 1.0 + exciter_.wandering_part * std::sin(two_pi * time_s / exciter_.wandering_period_s);
}

void Excitation::change(double time_s, const Drive& drive) {
  const Segment& last = segments_.back();
  Segment next;
  next.begin_s = time_s;
  const double turns = last.turns + (time_s - last.begin_s) * last.frequency_hz;
  next.turns = turns - std::floor(turns);
  next.frequency_hz = drive.frequency_hz;
  next.initial = envelope(last, time_s);
  next.target =
      drive.on ? drive.amplitude_v * exciter_.at(drive.frequency_hz) : std::complex<double>{};
  next.on = drive.on;
  next.amplitude_v = drive.on ? drive.amplitude_v : 0.0;
  drive_ = drive;
  segments_.push_back(next);
  while (segments_.size() > 2 && segments_[1].begin_s < time_s - memory_s) {
    segments_.pop_front();
  }
}

Motion Excitation::motion(double time_s) const {
  const Segment& segment = segment_at(time_s);
  const double turns = segment.turns + (time_s - segment.begin_s) * segment.frequency_hz;
  const double angle = two_pi * (turns - std::floor(turns));
  return {.sine = std::sin(angle),
          .cosine = std::cos(angle),
          .envelope = wandering(time_s) * envelope(segment, time_s),
          .frequency_hz = segment.frequency_hz,
          .sync_on = segment.on,
          .generator_v = segment.amplitude_v,
          .since_change_s = std::max(0.0, time_s - segment.begin_s)};
}

double Excitation::acceleration(const Motion& motion, const HarmonicGains& gains) const {
  const std::complex<double> fundamental = motion.envelope * gains.first;
  const double amplitude = std::abs(motion.envelope);
  const double sine2 = 2.0 * motion.sine * motion.cosine;
  const double cosine2 = motion.cosine * motion.cosine - motion.sine * motion.sine;
  const double sine3 = sine2 * motion.cosine + cosine2 * motion.sine;
  const double cosine3 = cosine2 * motion.cosine - sine2 * motion.sine;
  const double second = second_.real() * sine2 + second_.imag() * cosine2;
  const double third = third_.real() * sine3 + third_.imag() * cosine3;
  return fundamental.real() * motion.sine + fundamental.imag() * motion.cosine +
         amplitude * (gains.second * second + gains.third * third);
}

} // namespace dyncal::drivers::virtual_bench
