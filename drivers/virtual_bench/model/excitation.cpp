#include "drivers/virtual_bench/model/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double crest_factor = 3.6; // of a multi-sine: sync stays within its amplitude

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

const Excitation::Segment& Excitation::segment_at(const Line& line, double time_s) {
  std::size_t i = line.size() - 1;
  while (i > 0 && line[i].begin_s > time_s) {
    --i;
  }
  return line[i];
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
  std::vector<DriveLine> lines = drive.lines;
  if (lines.empty()) {
    lines.push_back({drive.frequency_hz, drive.amplitude_v, 0.0});
  }
  const bool keeps_phases = drive.lines.empty() || (drive_.on && same_frequencies(drive_, drive));
  lines_.resize(std::max(lines_.size(), lines.size()), Line{Segment{}});
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
  const Segment& last = line.back();
  Segment next;
  next.begin_s = time_s;
  const double turns = keeps_phase ? last.turns + (time_s - last.begin_s) * last.frequency_hz
                                   : drive.phase_rad / two_pi;
  next.turns = turns - std::floor(turns);
  next.frequency_hz = drive.frequency_hz;
  next.initial = envelope(last, time_s);
  next.target = on ? drive.amplitude_v * exciter_.at(drive.frequency_hz) : std::complex<double>{};
  next.on = on;
  next.amplitude_v = on ? drive.amplitude_v : 0.0;
  line.push_back(next);
  while (line.size() > 2 && line[1].begin_s < time_s - memory_s) {
    line.pop_front();
  }
}

Motion Excitation::motion(double time_s, std::size_t line) const {
  const Segment& segment = segment_at(lines_[line], time_s);
  const double turns = segment.turns + (time_s - segment.begin_s) * segment.frequency_hz;
  const double angle = two_pi * (turns - std::floor(turns));
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

} // namespace dyncal::drivers::virtual_bench
