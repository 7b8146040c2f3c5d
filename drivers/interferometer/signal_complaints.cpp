#include "drivers/interferometer/signal_complaints.hpp"

#include <cmath>

#include "analysis/interferometer/rounded_text.hpp"

namespace dyncal::drivers::interferometer {
namespace {

constexpr double quiet_s = 10.0;
constexpr double radius_every_s = 1.0;
constexpr double patience_s = 5.0;
constexpr double other_radius_rel = 0.2;

std::string text(double value) {
  return analysis::rounded_text(value, 2);
}

} // namespace

bool SignalComplaints::is_new(Subject subject) {
  const bool is_new = now_s_ - last_s_[subject] > quiet_s;
  last_s_[subject] = now_s_;
  return is_new;
}

void SignalComplaints::look(QuadratureDemodulator& demodulator, std::size_t pairs,
                            SampleSink& sink) {
  now_s_ += static_cast<double>(pairs) / rate_hz_;
  look_at_counts(demodulator.counts(), sink);
  if (demodulator.has_ellipse()) {
    without_ellipse_since_s_ = now_s_;
  } else if (now_s_ - without_ellipse_since_s_ > patience_s && is_new(no_ellipse)) {
    sink.warn("the ellipse of " + pair_ + " is not known yet, so that there is no displacement: " +
              (demodulator.problem().empty() ? "no signals have come" : demodulator.problem()) +
              ". Drive the exciter at a low frequency, let the table drift by half a wavelength, "
              "or name a file with the key 'ellipse'");
  }
  if (now_s_ - radius_since_s_ >= radius_every_s) {
    radius_since_s_ = now_s_;
    look_at_radius(demodulator, sink);
    demodulator.forget_radius();
  }
}

void SignalComplaints::look_at_counts(const DemodulationCounts& now, SampleSink& sink) {
  if (now.not_measured > before_.not_measured && is_new(not_measured)) {
    sink.warn("samples of " + pair_ + " are no numbers; the displacement lacks there");
  }
  if (now.clipped > before_.clipped && is_new(clipped)) {
    sink.warn(pair_ + " reach an end of the range of their channels, and the displacement lacks "
                      "where they do; lower the gain of the detectors, or choose a wider range");
  }
  if (now.without_beam > before_.without_beam && is_new(without_beam)) {
    sink.warn(pair_ + " have less than a fifth of the radius of their ellipse: is the beam "
                      "interrupted, or the mirror out of adjustment? The displacement lacks as "
                      "long as it lasts");
  }
  if (now.doubtful > before_.doubtful && is_new(doubtful)) {
    sink.warn("the phase of " + pair_ +
              " moves by more than a quarter of a turn from sample to sample beside what is "
              "expected of it; turns may be lost there, and the displacement lacks at these "
              "samples. Take a higher sample rate, or look for knocks and noise");
  }
  before_ = now;
}

void SignalComplaints::look_at_radius(QuadratureDemodulator& demodulator, SampleSink& sink) {
  const auto ratio = demodulator.radius_ratio();
  const auto radius = demodulator.radius_over_stated();
  if (ratio && *ratio < analysis::smallest_radius_ratio && is_new(slow)) {
    sink.warn("the radius of " + pair_ + " falls to " + text(*ratio) +
              " of its largest: are the detectors too slow for these fringes, or does the light "
              "change? The delay of slow detectors depends on the velocity, and no correction "
              "covers it");
  }
  if (radius && std::abs(*radius - 1.0) > other_radius_rel && is_new(other_radius)) {
    sink.warn("the radius of " + pair_ + " is " + text(*radius) +
              " of that of their ellipse: does the ellipse belong to this adjustment of the "
              "interferometer?");
  }
}

} // namespace dyncal::drivers::interferometer
