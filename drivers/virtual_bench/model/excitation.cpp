#include "drivers/virtual_bench/model/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double crest_factor = 3.6; // of a multi-sine: sync stays within its amplitude

constexpr double instant_s = 1e-6; // over which a velocity is taken

const ExcitationSegment& segment_at(const Excitation::Line& line, double time_s) {
  std::size_t i = line.size() - 1;
  while (i > 0 && line[i].begin_s > time_s) {
    --i;
  }
  return line[i];
}

// What is left of the change at the beginning of the segment: 1 then, 0 in the end.
double left_of_change(const ExcitationSegment& segment, double time_s) {
  const double x = (time_s - segment.begin_s) / segment.decay_s;
  return x > 40.0 ? 0.0 : std::exp(-std::max(x, 0.0));
}

std::complex<double> envelope(const ExcitationSegment& segment, double time_s) {
  return segment.target + (segment.initial - segment.target) * left_of_change(segment, time_s);
}

double carrier_angle(const ExcitationSegment& segment, double time_s) {
  const double turns = segment.turns + (time_s - segment.begin_s) * segment.frequency_hz;
  return two_pi * (turns - std::floor(turns));
}

bool same_frequencies(const Drive& one, const Drive& other) {
  return std::ranges::equal(one.lines, other.lines, {}, &DriveLine::frequency_hz,
                            &DriveLine::frequency_hz);
}

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

double Excitation::wandering(double time_s) const {
  return 1.0 + exciter_.wandering_part * std::sin(two_pi * time_s / exciter_.wandering_period_s);
}

void Excitation::change(double time_s, const Drive& drive) {
  std::vector<DriveLine> lines = drive.lines;
  if (lines.empty()) {
    lines.push_back({drive.frequency_hz, drive.amplitude_v, 0.0});
  }
  const bool keeps_phases = drive.lines.empty() || (drive_.on && same_frequencies(drive_, drive));
  lines_.resize(std::max(lines_.size(), lines.size()), Line{ExcitationSegment{}});
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const bool is_driven = i < lines.size();
    const DriveLine line = is_driven ? lines[i] : DriveLine{lines_[i].back().frequency_hz};
    change(lines_[i], time_s, line, drive.on && is_driven, keeps_phases || !is_driven);
    lines_[i].back().sync_part =
        drive.lines.empty()
            ? 1.0
            : 1.0 / (crest_factor * std::sqrt(0.5 * static_cast<double>(lines.size())));
  }
  drive_ = drive;
}

void Excitation::change(Line& line, double time_s, const DriveLine& drive, bool on,
                        bool keeps_phase) const {
  const ExcitationSegment& last = line.back();
  ExcitationSegment next;
  next.begin_s = time_s;
  const double turns = keeps_phase ? last.turns + (time_s - last.begin_s) * last.frequency_hz
                                   : drive.phase_rad / two_pi;
  next.turns = turns - std::floor(turns);
  next.frequency_hz = drive.frequency_hz;
  next.initial = envelope(last, time_s);
  next.target = on ? drive.amplitude_v * exciter_.at(drive.frequency_hz) : std::complex<double>{};
  next.decay_s = on ? exciter_.settling_time_s : exciter_.ring_down_s;
  next.on = on;
  next.amplitude_v = on ? drive.amplitude_v : 0.0;
  const auto missing_m = [&](double from_change_s) {
    const double at_s = time_s + from_change_s;
    return displacement_in(last, at_s) - displacement_in(next, at_s);
  };
  const double missing_now_m = missing_m(0.0);
  next.velocity_m_s = (missing_m(instant_s) - missing_now_m) / instant_s;
  next.position_m = missing_now_m;
  line.push_back(next);
  while (line.size() > 2 && line[1].begin_s < time_s - memory_s) {
    line.pop_front();
  }
}

Motion Excitation::motion(double time_s, std::size_t line) const {
  const ExcitationSegment& segment = segment_at(lines_[line], time_s);
  const double angle = carrier_angle(segment, time_s);
  return {.sine = std::sin(angle),
          .cosine = std::cos(angle),
          .envelope = wandering(time_s) * envelope(segment, time_s),
          .frequency_hz = segment.frequency_hz,
          .sync_on = segment.on,
          .generator_v = segment.amplitude_v,
          .sync_part = segment.sync_part,
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

double Excitation::displacement(double time_s, std::size_t line) const {
  return displacement_in(segment_at(lines_[line], time_s), time_s);
}

double Excitation::displacement_in(const ExcitationSegment& segment, double time_s) const {
  const DisplacementTerms terms = displacement_terms(segment, second_, third_);
  const double left = left_of_change(segment, time_s);
  const std::complex<double> carrier = std::polar(1.0, carrier_angle(segment, time_s));
  const double from_begin_s = time_s - segment.begin_s;
  const double moved = std::imag((terms.settled + terms.changing * left) * carrier) +
                       std::abs(envelope(segment, time_s)) *
                           std::imag((terms.second + terms.third * carrier) * carrier * carrier);
  return wandering(time_s) * moved + (segment.position_m + terms.return_m_s * from_begin_s) *
                                         std::exp(-from_begin_s / suspension_s);
}

DisplacementTerms displacement_terms(const ExcitationSegment& segment,
                                     std::complex<double> second_harmonic,
                                     std::complex<double> third_harmonic) {
  const double angular_hz = two_pi * segment.frequency_hz;
  const std::complex<double> steady(0.0, angular_hz);
  const std::complex<double> decaying(-1.0 / segment.decay_s, angular_hz);
  return {.settled = segment.target / (steady * steady),
          .changing = (segment.initial - segment.target) / (decaying * decaying),
          .second = second_harmonic / (4.0 * steady * steady),
          .third = third_harmonic / (9.0 * steady * steady),
          .return_m_s = segment.velocity_m_s + segment.position_m / Excitation::suspension_s};
}

} // namespace dyncal::drivers::virtual_bench
