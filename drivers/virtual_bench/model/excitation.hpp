// What the generator and the exciter do as a function of bench time.
//
// The generator is phase continuous: V sin(theta(t)), theta' = 2 pi f; its second output, locked to
// the first, gives the sync signal of constant amplitude.
//
// The exciter turns V into acceleration with a magnitude and phase response of its own; after every
// change the complex envelope approaches its new value with exp(-t/settling time), or 0 with
// exp(-t/ring-down time) when the output is switched off. Second and third harmonic are in a fixed
// ratio to the fundamental.
//
// An arbitrary waveform is a set of lines at once, each as if it were alone; its phases are those
// at the instant at which the output is switched on. The sync output has all lines with equal
// amplitudes then.
//
// Displacement is the double integral of the acceleration: of the fundamental exactly, also while
// the envelope changes; of the harmonics and of an amplitude that wanders as if they were settled.
// Each change leaves a step in position and velocity of that integral, which the suspension takes
// back with exp(-t/25 ms); the sensors' model does not show the acceleration of that.
//
// Bench time is in seconds from the start of the bench. Times may be asked for up to `memory_s`
// before the newest change. One thread.
#pragma once

#include <complex>
#include <deque>
#include <vector>

#include "drivers/virtual_bench/model/response.hpp"

namespace dyncal::drivers::virtual_bench {

struct DriveLine { // of an arbitrary waveform
  double frequency_hz = 0.0;
  double amplitude_v = 0.0;
  double phase_rad = 0.0; // of its sine, lead

  bool operator==(const DriveLine&) const = default;
};

struct Drive { // what the generator is set to
  double frequency_hz = 100.0;
  double amplitude_v = 0.0; // zero to peak
  bool on = false;
  bool rectangle = false;         // of the sync line only; the exciter keeps its sine
  std::vector<DriveLine> lines{}; // in place of the sine; empty: none
};

struct ExciterModel {
  double acceleration_per_volt = 50.0; // m/s^2 per V at low frequency
  double settling_time_s = 0.04;
  double ring_down_s = 0.04; // likewise, of what it does when the generator's output is off
  double delay_s = 0.21e-3;
  double corner_hz = 900.0;
  double second_harmonic = 0.004; // parts of the fundamental, -40..-60 dB
  double third_harmonic = 0.002;
  double second_phase_rad = 0.0;
  double third_phase_rad = 0.0;
  double wandering_part = 0.0; // of the amplitude, a sine
  double wandering_period_s = 1.0;

  [[nodiscard]] std::complex<double> at(double frequency_hz) const; // m/s^2 per V
};

// The state of the carrier at one instant.
struct Motion {
  double sine = 0.0; // of theta
  double cosine = 1.0;
  std::complex<double> envelope{}; // fundamental is Im{envelope * e^{i theta}}
  double frequency_hz = 0.0;
  bool sync_on = false;
  double generator_v = 0.0;    // amplitude of the generator's first output, zero to peak
  double sync_part = 1.0;      // of the amplitude of sync, what this line has
  double since_change_s = 0.0; // since the generator was last changed
};

// Response at the fundamental and the harmonics, without the delay (which shifts the instant
// instead).
struct HarmonicGains {
  std::complex<double> first{1.0, 0.0};
  double second = 1.0;
  double third = 1.0;
};
[[nodiscard]] HarmonicGains harmonic_gains(const AxisResponse& response, double frequency_hz);

// A line between two changes of the generator.
struct ExcitationSegment {
  double amplitude_v = 0.0; // of the first output
  double begin_s = 0.0;
  double turns = 0.0; // of the carrier at the beginning, 0..1
  double frequency_hz = 100.0;
  std::complex<double> target;  // envelope in the end
  std::complex<double> initial; // envelope at the beginning
  double decay_s = 0.04;        // time constant from the one to the other
  bool on = false;
  double sync_part = 1.0;
  double position_m = 0.0; // at the beginning, which the suspension takes back
  double velocity_m_s = 0.0;
};

// With the carrier c = e^{i theta}, the envelope E and t since the beginning of the segment:
//
//   s = Im{(settled + changing exp(-t/decay)) c} + |E| Im{second c^2 + third c^3}
//       + (position + return_m_s t) exp(-t/suspension)
struct DisplacementTerms {
  std::complex<double> settled;
  std::complex<double> changing;
  std::complex<double> second;
  std::complex<double> third;
  double return_m_s = 0.0;
};
[[nodiscard]] DisplacementTerms displacement_terms(const ExcitationSegment& segment,
                                                   std::complex<double> second_harmonic,
                                                   std::complex<double> third_harmonic);

class Excitation {
public:
  static constexpr double memory_s = 1.0;
  static constexpr double suspension_s = 0.025;
  using Line = std::deque<ExcitationSegment>; // in the order of their beginnings

  explicit Excitation(const ExciterModel& exciter)
      : exciter_(exciter), lines_(1, Line{ExcitationSegment{}}),
        second_(std::polar(exciter.second_harmonic, exciter.second_phase_rad)),
        third_(std::polar(exciter.third_harmonic, exciter.third_phase_rad)) {}

  // From `time_s` on; REQUIRES: not before the last change.
  void change(double time_s, const Drive& drive);

  [[nodiscard]] const Drive& drive() const { return drive_; }
  // Lines that were excited at once so far, in their order; of a sine one.
  [[nodiscard]] std::size_t lines() const { return lines_.size(); }
  [[nodiscard]] Motion motion(double time_s, std::size_t line = 0) const;
  // Acceleration of the moving table in m/s^2 as something with these gains sees it.
  [[nodiscard]] double acceleration(const Motion& motion, const HarmonicGains& gains) const;
  // Of the moving table in m, by one line alone.
  [[nodiscard]] double displacement(double time_s, std::size_t line = 0) const;

  // What the motion is made of.
  [[nodiscard]] const Line& segments(std::size_t line) const { return lines_[line]; }
  [[nodiscard]] std::complex<double> second_harmonic() const { return second_; } // of |envelope|
  [[nodiscard]] std::complex<double> third_harmonic() const { return third_; }
  [[nodiscard]] double wandering(double time_s) const; // factor of the envelope

private:
  void change(Line& line, double time_s, const DriveLine& drive, bool on, bool keeps_phase) const;
  [[nodiscard]] double displacement_in(const ExcitationSegment& segment, double time_s) const;

  ExciterModel exciter_;
  std::vector<Line> lines_;
  std::complex<double> second_; // harmonics relative to the fundamental
  std::complex<double> third_;
  Drive drive_;
};

} // namespace dyncal::drivers::virtual_bench
